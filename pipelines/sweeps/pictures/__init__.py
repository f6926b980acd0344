"""How a sweep is drawn: curves and points of one setting, heat maps of two, all of many."""
