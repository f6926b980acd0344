"""Recorders: one module each, with one YAML file each in ``conf/recorder``."""
