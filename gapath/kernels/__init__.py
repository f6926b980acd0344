"""Jitted free functions on arrays, by topic."""
