"""What a planner tells of how it came to its answer."""
