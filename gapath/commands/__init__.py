"""The commands: nothing but arguments and words."""
