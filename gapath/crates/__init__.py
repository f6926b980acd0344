"""Crates: runs that can be handed over, with what they were made of, and done again elsewhere."""
