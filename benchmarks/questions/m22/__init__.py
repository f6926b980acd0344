"""Questions about M22's planner."""
