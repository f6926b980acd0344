"""Sections for experiments of one's own, and what is told of every experiment alike."""
