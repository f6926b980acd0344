"""Experiments that are made up: runs, as they are read, and their trials."""

import math
import zlib
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from gapath.pipelines.page.section import Section
from gapath.pipelines.sweeps import table

from ..conftest import record_of
from ..synthetic import METRICS, NOTHING

Runs = list[Any]


class Tried(NamedTuple):
    """A run: what it tries, on what, and how often that succeeds."""

    preset: str = "ga1"
    changes: Mapping[str, Any] = NOTHING
    map: str = "kg18_test3"
    instance: int = 0
    start: str = "(0, 0)"
    seed: int = 0
    n: int = 10
    success: float = 0.5
    evaluations: int = 100
    path: str = ""


def planned(tried: Iterable[Tried], experiment: str = "mine") -> tuple[pd.DataFrame, Runs]:
    """Make plans: of each run's n trials the first succeed, whose evaluations grow by one."""
    frames, runs = [], []
    for i, each in enumerate(tried):
        run = _run(each, f"k{i}")
        number = np.arange(each.n)
        found = number < round(each.success * each.n)
        spent = (each.evaluations + number) * (each.evaluations > 0)
        frame = _frame(each, run, experiment).assign(
            planner=run.known.method, status=np.where(found, "found", "not_found"),
            feasible=found, cost=11.0, optimal_cost=10.0, minimises="weights",
            optimality_ratio=np.where(found, 1.1, math.nan), obstacles=0,
            epochs=spent // 10, evaluations=spent, expansions=0,
            plan_time_s=1e-3 * (1 + number), stage_times_s="{}",
        )  # fmt: skip
        frames.append(frame)
        runs.append(run)
    return pd.concat(frames, ignore_index=True), runs


def driven(tried: Iterable[Tried], experiment: str = "mine") -> tuple[pd.DataFrame, Runs]:
    """Make drives: of each run's n the first reach the target, the others return."""
    frames, runs = [], []
    for i, each in enumerate(tried):
        run = _run(each, f"d{i}", task="drive")
        reached = np.arange(each.n) < round(each.success * each.n)
        steps = 20 + np.arange(each.n)
        frame = _frame(each, run, experiment).assign(
            navigator=run.known.method, outcome=np.where(reached, "reached", "returned"),
            reached=reached, steps=steps, shortest_steps=20.0,
            steps_ratio=np.where(reached, steps / 20, math.nan), ga_calls=1, calls_a=0,
            calls_b=0, calls_c=1, replans=0, returns=~reached, stands=0,
            evaluations=each.evaluations, seen_fields=9, cost=11.0, compute_time_s=0.25,
        )  # fmt: skip
        frames.append(frame)
        runs.append(run)
    return pd.concat(frames, ignore_index=True), runs


def _run(each: Tried, key: str, task: str = "plan") -> Any:
    known = {"map": each.map, "map_instance": each.instance, "start": each.start}
    known |= {"seed": each.seed, "trials": each.n}
    if each.path:
        known["map_inputs"] = {each.path: f"{zlib.crc32(each.path.encode()):08x}"}
    run = record_of(each.preset, key, task, each.changes, **known)
    if each.path:
        vars(run)["settings"] |= {"map.kind": "movingai", "map.path": each.path}
    return run


def _frame(each: Tried, run: Any, experiment: str) -> pd.DataFrame:
    return pd.DataFrame({"trial": np.arange(each.n)}).assign(
        experiment=experiment, map=each.map, map_instance=each.instance, map_source="reconstructed",
        map_digest=f"{each.map} {each.instance}", width=9, height=9, start=each.start,
        target="(9, 9)", corner_cutting="allow", seed=each.seed, published_length=math.nan,
        length_ratio=math.nan, key=run.folder.name, **METRICS,
    )  # fmt: skip


def grid(**settings: Iterable[Any]) -> list[dict[str, Any]]:
    """Give all combinations of values, as changes of a planner."""
    every: list[dict[str, Any]] = [{}]
    for name, values in settings.items():
        every = [{**each, f"planner.{name}": value} for each in every for value in values]
    return every


def sections(tried: Iterable[Tried], make: Any = planned) -> list[Section]:
    """Make the sections of what was tried."""
    return table.section(*make(tried))


def names_of(section: Section) -> list[str]:
    """Give the names of a section's tables and figures."""
    return [each.name for each in (*section.tables, *section.figures)]


def by_name(section: Section, end: str) -> Any:
    """Give the table or figure whose name ends so."""
    (found,) = [each for each in (*section.tables, *section.figures) if each.name.endswith(end)]
    return found
