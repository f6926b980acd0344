"""Whether groups of trials differ, and by how much."""
