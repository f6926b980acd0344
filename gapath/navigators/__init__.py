"""Navigators: one module each, with a YAML file each in ``conf/navigator``."""
