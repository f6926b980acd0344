"""Measurements: one module a question, each with a ``measure(quick)`` that gives rows."""
