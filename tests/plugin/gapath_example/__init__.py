"""A component of each kind for gapath, each in one file."""
