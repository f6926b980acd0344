"""Generators of KG18's map classes, and what all generators share."""
