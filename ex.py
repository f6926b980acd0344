import gapath

plan = gapath.plan(gapath.load_map("kg18_test3"), planner="ga3", seed=7, min_epochs=100)
plan.convergence()
