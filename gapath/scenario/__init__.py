"""Pairs of start and target on a map: as a file lists them, drawn, or nearest to what was asked."""
