"""The genetic planner of our own in the field, against exact planners on many maps."""
