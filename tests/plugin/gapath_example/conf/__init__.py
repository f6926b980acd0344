"""Configurations: one YAML a component."""
