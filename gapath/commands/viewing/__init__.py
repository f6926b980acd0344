"""Seeing a run: in the viewer, in a browser, as a picture, as a movie."""
