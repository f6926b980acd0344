"""What the columns of ``trials.parquet`` mean: name -> unit and meaning."""

from gapath.discovery import kinds, load
from gapath.task import columns, find_task, metrics

COLUMNS = {
    "experiment": ("", "name of the experiment"),
    "map": ("", "name of the map"),
    "map_instance": ("number", "of the map within its class; 0: the canonical one, or no class"),
    "map_source": ("", "where the map comes from: reconstructed, generated, drawn, array, or the "
                   "format of its file"),
    "map_digest": ("", "SHA-256 of what a planner sees of the map"),
    "width": ("fields", "columns of the map"),
    "height": ("fields", "rows of the map"),
    "start": ("fields", "(x, y), (0, 0) top left"),
    "target": ("fields", "(x, y)"),
    "corner_cutting": ("", "rule for diagonal steps past obstacles"),
    "seed": ("number", "random streams are keyed by (seed, trial)"),
    "trial": ("number", "of the trial within its run, from 0"),
    "published_length": ("fields", "octile length that the map's author gives; NaN: none"),
    "length_ratio": ("ratio", "octile length of the path over the published one; NaN: one of them "
                     "is missing"),
    "planner": ("", "name of the planner, with what differs from its YAML"),
    "navigator": ("", "name of the navigator, with what differs from its YAML"),
    "status": ("", "how planning ended: found, not_found, infeasible or optimal"),
    "feasible": ("", "whether a path was found"),
    "cost": ("weight", "KG18 eq. (5): sum of the weights of the fields of the path, or of those "
             "that a robot passed; of a failed plan the best fitness, each obstacle counted as "
             "planner.vln"),
    "obstacles": ("fields", "obstacles on the best path; 0: it is free"),
    "optimal_cost": ("weight", "least cost of any path; infinite: there is none"),
    "minimises": ("", "what the planner minimises: weights or length"),
    "optimality_ratio": ("ratio", "what the path has of that over the least there is; NaN: not "
                         "known"),
    "epochs": ("epochs", "of the genetic algorithm; 1 is the initial population"),
    "evaluations": ("chromosomes", "whose fitness was computed"),
    "expansions": ("fields", "that a graph search expanded"),
    "plan_time_s": ("s", "wall time of the planner's call"),
    "stage_times_s": ("s", "wall time of each of the planner's stages, as JSON"),
    "row": ("number", "of the problem in its scenario, from 0"),
    "bucket": ("number", "class of difficulty that the scenario gives; else the octile length of "
               "the path of least cost over four, -1 without a path"),
    "outcome": ("", "how the drive ended: reached, returned or overran"),
    "reached": ("", "whether the robot reached its target"),
    "steps": ("steps", "that the drive took"),
    "shortest_steps": ("steps", "of a shortest path on the true map"),
    "steps_ratio": ("ratio", "steps over shortest_steps; NaN: not reached"),
    "ga_calls": ("calls", "runs of the genetic algorithm"),
    "calls_a": ("calls", "of any planner by part A, the way back"),
    "calls_b": ("calls", "of any planner by part B, which explores"),
    "calls_c": ("calls", "of any planner by part C, which replans"),
    "replans": ("steps", "in which the current path had met an obstacle"),
    "returns": ("times", "that the way back began"),
    "stands": ("steps", "without a move"),
    "seen_fields": ("fields", "that the robot has seen"),
    "compute_time_s": ("s", "wall time of looking and deciding"),
}  # fmt: skip
"""Of gapath's own tasks; the columns of metrics are told by their modules."""


def all_columns() -> list[str]:
    """Give the names of all columns of all tasks."""
    return list(dict.fromkeys(n for task in kinds("task") for n in columns(find_task(task).row)))


def column(name: str) -> tuple[str, str]:
    """Give unit and meaning of a column; both are empty for one of another package's task."""
    if name not in metrics():
        return COLUMNS.get(name, ("", ""))
    module = load("metric", name)
    unit = module.TITLE.partition(", ")[2] or "number"
    return unit, " ".join((module.__doc__ or "").partition("\n\n")[0].split())
