"""The memetic planner: wall following finds a path, a genetic algorithm shortens it."""
