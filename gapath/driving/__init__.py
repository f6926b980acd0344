"""One drive through an unknown map: what a robot knows, sees and decides, step by step."""
