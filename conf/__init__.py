"""Hydra configuration: groups map, planner, recorder and experiment."""
