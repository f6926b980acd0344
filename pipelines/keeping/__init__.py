"""Keeping house: what people say of runs, what goes, what is handed on."""
