"""Planners: one module each, with one YAML file each in ``conf/planner``."""
