"""M22 Sec. III: ten scenes, the paper's planner beside exact ones and free points."""

import json
import math
from collections import defaultdict
from collections.abc import Sequence

import numpy as np
import pandas as pd

from gapath.pipelines.m22.remarks import remarks_of
from gapath.pipelines.numbers.grouped import Groups, grouped
from gapath.pipelines.numbers.statistics import wilson
from gapath.pipelines.numbers.text import NOTHING, number, percent, percent_range, tenths
from gapath.pipelines.page.section import Section, Table
from gapath.pipelines.papers.m22 import EXACT, MAPS, PAPER
from gapath.pipelines.papers.names import label, rank
from gapath.store.records import RunRecord

TASK = "plan"
EXPERIMENT = "m22"
ORDER = 92

SCENES = (
    "The scenes marked reconstructed are not the paper's: its figures are lost. They were drawn "
    "by a seeded generator: six convex obstacles, start at the lower left, end at the right border."
)

STAGES = ("resizing", "dilation", "keypoints", "graph", "genetic algorithm", "search", "planning")


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section:
    """Make the section on M22's scenes.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section
        Methods beside the paper's, scene by scene, and where the time goes.
    """
    trials = with_references(trials)
    methods, stages = summarise_methods(trials), summarise_stages(trials)
    return Section(
        title="M22: from an image to a visibility graph to a genetic algorithm",
        text=(
            "White obstacles on a black floor are grown by the robot's radius; the ends of their "
            "main axes are keypoints; straight lines between these that meet no obstacle make a "
            "graph; a genetic algorithm looks for the shortest path through it, f being its "
            "length in pixels. It stops after 20 generations without a shorter path, as in the "
            "paper's ten tests, or takes 829 (unlimited), as in one more.",
            SCENES,
        ),
        tables=(
            _methods(methods).with_runs(trials, ["planner"]),
            _scenes(trials).with_runs(trials, ["map"]),
            _stages(stages).with_runs(trials, ["planner"]),
        ),
        remarks=remarks_of(methods, stages),
    )


def with_references(trials: pd.DataFrame) -> pd.DataFrame:
    """Put beside each trial what exact planners found on its scene.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.

    Returns
    -------
    DataFrame
        With `gap`, f above the shortest path of the same graph, and `above_pixels`, octile length
        above that of A* on the pixel grid; both as a part of the reference, missing where there
        is none.
    """
    found = trials[trials["feasible"]]
    shortest = found.groupby(["map", "planner"])[["line_length", "length"]].min()
    names, groups = grouped(trials, ["map", "planner"])
    pairs = [(str(name), str(planner)) for name, planner in names.to_numpy()]
    graph = [_reference(shortest["line_length"], name, EXACT.get(of, of)) for name, of in pairs]
    pixels = [_reference(shortest["length"], name, "inflated_astar") for name, _ in pairs]
    known = trials["planner"].isin({*EXACT, *EXACT.values()})
    gap = (trials["line_length"] / np.array(graph)[groups.of] - 1).where(known)
    above = trials["length"] / np.array(pixels)[groups.of] - 1
    return trials.assign(gap=gap, above_pixels=above)


def _reference(lengths: pd.Series, name: str, planner: str) -> float:
    return float(lengths.get((name, planner), float("nan")))


def summarise_methods(trials: pd.DataFrame) -> pd.DataFrame:
    """Summarise each method over the scenes.

    Parameters
    ----------
    trials : DataFrame
        As `with_references` gives them.

    Returns
    -------
    DataFrame
        planner, scenes, n, found, success with its interval over scenes; f, gap and above_pixels
        of the trials that found a path, means of the scenes' means, since the fewer of a hard
        scene must not count less; the worst gap; mean epochs and evaluations and quartiles of
        seconds of all trials; the paper's f, generations and seconds.
    """
    methods = sorted(trials.groupby("planner"), key=lambda pair: rank(pair[0]))
    return pd.DataFrame([{"planner": name, **_summarise_method(own)} for name, own in methods])


def _summarise_method(trials: pd.DataFrame) -> dict[str, float]:
    scenes = trials.groupby("map")
    rates = scenes["feasible"].mean()
    low, high = wilson(float(rates.mean()), len(rates))
    evolves = trials["epochs"].gt(0).any()
    means = scenes[["line_length", "gap", "above_pixels"]].mean().mean()
    paper = PAPER.get(str(trials["planner"].iloc[0]), (math.nan,) * 3)
    seconds = Groups.one(len(trials)).spreads(trials["plan_time_s"])._asdict()
    return {
        "scenes": len(rates),
        "n": len(trials),
        "found": int(trials["feasible"].sum()),
        "success": rates.mean(),
        "success_low": low if evolves else math.nan,
        "success_high": high if evolves else math.nan,
        "f": means["line_length"],
        "gap": means["gap"],
        "worst_gap": trials["gap"].max(),
        "above_pixels": means["above_pixels"],
        "epochs": trials["epochs"].mean() if evolves else math.nan,
        "evaluations": trials["evaluations"].mean() if evolves else math.nan,
        **{f"seconds_{key}": float(value[0]) for key, value in seconds.items()},
        **{f"paper_{k}": v for k, v in zip(("f", "epochs", "seconds"), paper, strict=True)},
    }


def _methods(rows: pd.DataFrame) -> Table:
    shown = [
        {
            "Method": label(row["planner"]),
            "Trials": number(row["n"]),
            "Found, %": percent(row["success"]),
            "95 %": percent_range((row["success_low"], row["success_high"])),
            "f": _tenth(row["f"]),
            "f, paper": _tenth(row["paper_f"]),
            "f above shortest, %": tenths(100 * row["gap"]),
            "Octile above A*, %": tenths(100 * row["above_pixels"]),
            "Generations, mean": _tenth(row["epochs"]),
            "Generations, mean, paper": _tenth(row["paper_epochs"]),
            "Evaluations": number(round(row["evaluations"])) if row["epochs"] > 0 else NOTHING,
            "Time, ms": number(1000 * row["seconds_median"]),
            "Time, paper, s": number(row["paper_seconds"]),
        }
        for _, row in rows.iterrows()
    ]
    return Table(
        "m22",
        "M22 Sec. III over the scenes. Found: the mean of the scenes' rates with its 95 % Wilson "
        "interval over scenes. f: length of the straight lines of paths found, in pixels. Above "
        "shortest: f over the shortest path of the same graph. Octile: length of the path's fields "
        "over that of A* on the pixel grid, obstacles grown alike. All three are means of the "
        "scenes' means. "
        "Generations and evaluations: means of all trials. Time: from picture to path, median.",
        rows,
        pd.DataFrame(shown),
        heads=1,
    )


def _tenth(value: float) -> str:
    return NOTHING if pd.isna(value) else f"{value:.1f}".removesuffix(".0")


def _scenes(trials: pd.DataFrame) -> Table:
    rows, shown = [], []
    names = [name for name in MAPS if name in set(trials["map"])]
    others = sorted(set(trials["map"]) - set(names))
    for name in (*names, *others):
        here = trials[trials["map"] == name]
        source = str(here["map_source"].iloc[0])
        means: defaultdict[str, float] = defaultdict(lambda: math.nan)
        for planner, group in here.groupby("planner"):
            means[f"{planner} found"] = group["feasible"].mean()
            means[f"{planner} f"] = group["line_length"].mean()
            means[f"{planner} length"] = group["length"].mean()
            means[f"{planner} epochs"] = group["epochs"].mean()
        rows.append({"map": name, "map_source": source, **means})
        shown.append(
            {
                "Scene": label(name, source),
                "Shortest f": _tenth(means["visibility_dijkstra f"]),
                "M22: found, %": _rate(means["visibility_ga found"]),
                "M22: f": _tenth(means["visibility_ga f"]),
                "M22: generations": _tenth(means["visibility_ga epochs"]),
                "Unlimited: found, %": _rate(means["visibility_ga_unlimited found"]),
                "Unlimited: f": _tenth(means["visibility_ga_unlimited f"]),
                "Resized: f": _tenth(means["visibility_ga_resized f"]),
                "Corners: shortest f": _tenth(means["visibility_dijkstra_corners f"]),
                "Corners: f": _tenth(means["visibility_ga_corners f"]),
                "GA 3: f": _tenth(means["inflated_ga3 f"]),
                "Pixels: octile": _tenth(means["inflated_astar length"]),
            }
        )
    return Table(
        "m22_scenes",
        "Scene by scene: mean f, in pixels, of the trials that found a path, and the exact "
        "shortest f on the graph of axes' ends and on that of corners. The last column is the "
        "octile length of the shortest path on the pixel grid, which moves in eight directions "
        "only.",
        pd.DataFrame(rows),
        pd.DataFrame(shown),
        heads=1,
    )


def _rate(value: float) -> str:
    return NOTHING if pd.isna(value) else percent(value)


def summarise_stages(trials: pd.DataFrame) -> pd.DataFrame:
    """Give the median time of each stage.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.

    Returns
    -------
    DataFrame
        planner, then a column a stage in seconds, missing where a planner has no such stage.
    """
    times = {name: np.full(len(trials), np.nan) for name in STAGES}
    met = set()
    for i, text in enumerate(trials["stage_times_s"]):
        for name, seconds in json.loads(text).items():
            if name in times:
                times[name][i] = seconds
                met.add(name)
    stages = pd.DataFrame({name: times[name] for name in STAGES if name in met})
    medians = stages.groupby(trials["planner"].to_numpy()).median().rename_axis("planner")
    return medians.loc[sorted(medians.index, key=rank)].reset_index()


def _stages(medians: pd.DataFrame) -> Table:
    stages = [name for name in STAGES if name in medians]
    shown = [
        {
            "Method": label(row["planner"]),
            **{f"{name.capitalize()}, ms": number(1000 * row[name]) for name in stages},
        }
        for _, row in medians.iterrows()
    ]
    return Table(
        "m22_stages",
        "Where the time goes: median of each stage over all trials. Resizing is the search for the "
        "coarsest scale that closes no gap; planning, of what is not the paper's, the whole search "
        "on the pixel grid.",
        medians,
        pd.DataFrame(shown),
        heads=1,
    )
