"""Sections for any experiment that no paper has."""
