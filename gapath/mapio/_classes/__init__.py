"""Generators of KG18's map classes."""
