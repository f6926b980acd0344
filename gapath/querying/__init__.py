"""A planning query as a trial: its row, and how it is told as events."""
