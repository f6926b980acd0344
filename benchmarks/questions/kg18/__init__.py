"""Questions about KG18's planner and its drives."""
