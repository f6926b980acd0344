"""Questions about S04's planner."""
