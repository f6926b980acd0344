"""Metrics: one module each, and each is a column of every row, table and CSV."""
