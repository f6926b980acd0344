import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from gapath.api import load_map
from gapath.components import build
from gapath.discovery import yaml_names, yaml_values
from gapath.errors import InputError
from gapath.mapio import scene
from gapath.pipelines.m22 import figure_concave as figure_m22_concave
from gapath.pipelines.m22 import figure_convergence as figure_m22_convergence
from gapath.pipelines.m22 import figure_paths as figure_m22_paths
from gapath.pipelines.m22 import figure_pipeline as figure_m22_pipeline
from gapath.pipelines.m22 import logs as m22_logs
from gapath.pipelines.m22 import table as table_m22
from gapath.pipelines.papers import m22
from gapath.pipelines.report.report import make_report
from gapath.problem import Problem
from gapath.recorders import mcap
from gapath.running.config import Run
from gapath.running.experiment import execute
from gapath.running.naming import Method
from gapath.store.records import find_runs
from gapath.tasks.plan import Task as PlanTask

from .conftest import collect
from .synthetic import plan_settings

PLANNERS = {
    "visibility_ga": {},
    "visibility_ga_unlimited": {"max_epochs": 40},
    "visibility_dijkstra": {},
    "visibility_dijkstra_corners": {},
    "inflated_astar": {},
    "inflated_ga3": {},
}


def run(folder, experiment, grid, planner, trials=4, **values):
    made = build("planner", yaml_values("planner", planner) | values, "planner")
    problem = Problem(grid, grid.start, grid.target)
    recorders = [mcap.Recorder(step_s=0.1)]
    settings = plan_settings(planner, values)
    execute(
        Run(
            experiment, Method(planner), problem, PlanTask(made), recorders, 3, trials, settings,
            str(folder), False,
        ),
        f"gapath experiment={experiment}",
        progress=False,
    )  # fmt: skip


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    """Two small scenes with every kind of method, and the U."""
    folder = tmp_path_factory.mktemp("m22")
    for number in (1, 2):
        grid = scene.draw(number, 6, 400, 300)
        for planner, values in PLANNERS.items():
            run(folder, "m22", grid, planner, **values)
    for planner in ("visibility_ga", "visibility_ga_corners", "visibility_dijkstra_corners"):
        run(folder, "m22_concave", load_map("m22_u"), planner)
    return folder


@pytest.fixture(scope="module")
def plans(outputs):
    trials, skipped, _ = collect(outputs)
    plans = trials["plan"]
    assert not skipped
    return plans


def of(plans, experiment):
    return plans[plans["experiment"] == experiment]


def frame(planner, lengths, scene_name="m22_scene01", **columns):
    """Rows of trials, a missing length where no path was found."""
    lengths = np.array(lengths, dtype=float)
    rows = {
        "key": f"{scene_name} {planner}", "map": scene_name, "map_source": "reconstructed",
        "planner": planner,
        "feasible": ~np.isnan(lengths), "line_length": lengths, "length": lengths + 10,
        "epochs": 0 if "ga" not in planner else 30, "evaluations": 2100, "plan_time_s": 0.005,
        "stage_times_s": '{"dilation": 0.003, "search": 0.00002}',
    }  # fmt: skip
    return pd.DataFrame(rows | columns)


def test_the_papers_numbers_and_names():
    assert 1 - m22.PAPER["visibility_ga_unlimited"].length / m22.PAPER[
        "visibility_ga"
    ].length == pytest.approx(0.0783, abs=1e-4)
    named = {*m22.PLANNERS, *m22.RIVALS}
    assert named <= set(yaml_names("planner")) and set(m22.EXACT) | set(m22.PAPER) <= named
    assert {*m22.MAPS, m22.CONCAVE} <= set(yaml_names("map"))


def test_methods_by_hand():
    trials = pd.concat(
        [
            frame("visibility_ga", [110, 120, math.nan, math.nan]),
            frame("visibility_ga_unlimited", [100, 101, 102, 105], epochs=829),
            frame("visibility_dijkstra", [100]),
            frame("inflated_astar", [math.nan], feasible=True, length=100.0),
        ],
        ignore_index=True,
    )
    rows = table_m22.summarise_methods(table_m22.with_references(trials)).set_index("planner")
    limited, unlimited = rows.loc["visibility_ga"], rows.loc["visibility_ga_unlimited"]
    assert (limited["n"], limited["found"], limited["success"]) == (4, 2, 0.5)
    assert limited["f"] == 115 and limited["gap"] == pytest.approx(0.15)
    assert limited["above_pixels"] == pytest.approx(0.25)  # octile lengths 120 and 130
    assert unlimited["gap"] == pytest.approx(0.02) and unlimited["worst_gap"] == pytest.approx(0.05)
    assert (limited["paper_f"], limited["paper_epochs"]) == (1115, 51.5)
    assert math.isnan(rows.loc["visibility_dijkstra"]["epochs"])
    section = table_m22.section(trials, [])
    shown = section.tables[0].shown.set_index("Method")
    assert shown.loc["M22"]["Found, %"] == "50" and shown.loc["M22"]["f, paper"] == "1115"
    assert shown.loc["A* on pixels"]["f"] == "\N{EN DASH}"
    assert section.tables[2].shown.set_index("Method").loc["M22"]["Search, ms"] == "0.02"
    # (115 - 102) / 115
    assert "f is 11.3 % lower" in section.remarks[0] and "5.0 % at worst" in section.remarks[0]
    assert "50 % of the runs end without any path" in section.remarks[1]


def test_a_planner_with_other_settings_has_no_reference_of_its_own():
    trials = pd.concat(
        [frame("visibility_ga[robot_radius=9]", [110]), frame("visibility_dijkstra", [100])],
        ignore_index=True,
    )
    with_gap = table_m22.with_references(trials).set_index("planner")
    assert math.isnan(with_gap.loc["visibility_ga[robot_radius=9]"]["gap"])
    assert table_m22.section(trials, []).tables[0].shown["Method"].tolist() == [
        "M22 [robot_radius=9]",
        "Dijkstra on the graph",
    ]


def test_no_method_beats_the_shortest_path_of_its_graph(plans):
    rows = table_m22.with_references(of(plans, "m22"))
    assert (rows["gap"].dropna() >= 0).all() and (rows["gap"] == 0).any()
    assert (rows["above_pixels"].dropna() >= 0).all()
    stages = table_m22.section(of(plans, "m22"), []).tables[2].data
    assert set(stages.columns) == {
        "planner", "dilation", "keypoints", "graph", "genetic algorithm", "search", "planning",
    }  # fmt: skip


def test_figures_are_made_of_logs(outputs, plans):
    runs = find_runs(outputs)
    mine = [r for r in runs if r.known.experiment == "m22"]
    for module in (figure_m22_pipeline, figure_m22_convergence, figure_m22_paths):
        section = module.section(of(plans, "m22"), mine)
        assert len(section.figures) == 1 and not section.skipped
        assert section.figures[0].svg.startswith(b"<?xml")
        assert module.section(of(plans, "m22"), []) is None
    alt = figure_m22_pipeline.section(of(plans, "m22"), mine).figures[0].alt
    assert "24 keypoints, 325 lines of which" in alt  # 26 points


def test_a_grown_picture_has_the_maps_size(outputs):
    for run_ in find_runs(outputs):
        first = m22_logs.read_first(run_)
        if first.graph is None:
            continue
        grid = first.start.problem.map
        grown = first.graph.grown(grid.rows, grid.cols)
        assert grown.shape == (grid.rows, grid.cols)
        assert (grown | ~grid.obstacles).all()  # an obstacle is one
        if len(first.way_points):
            assert (first.way_points[0] == grid.start).all()
            assert (first.way_points[-1] == grid.target).all()
            assert (np.diff(first.way_points, axis=0) != 0).any(axis=1).all()


def test_the_u_fails_with_axes_and_works_with_corners(outputs, plans):
    runs = [r for r in find_runs(outputs) if r.known.experiment == "m22_concave"]
    section = figure_m22_concave.section(of(plans, "m22_concave"), runs)
    shown = section.tables[0].shown.set_index("Method")
    assert shown.loc["M22"]["No path in the graph, %"] == "100"
    assert shown.loc["Dijkstra on corners"]["Found, %"] == "100"
    assert "4 keypoints" in section.figures[0].alt and "no path" in section.figures[0].alt


def test_damaged_logs_are_skipped_and_named(outputs, plans, tmp_path):
    runs = [r for r in find_runs(outputs) if r.known.method == "visibility_ga"]
    broken = []
    for i, good in enumerate(runs):
        folder = tmp_path / str(i)
        folder.mkdir()
        (folder / "run.mcap").write_bytes(b"nothing")
        broken.append(replace(good, folder=folder))
    for module in (figure_m22_pipeline, figure_m22_convergence, figure_m22_paths):
        assert module.section(of(plans, "m22"), broken).skipped
    with pytest.raises(InputError):
        m22_logs.read_first(broken[0])


@pytest.mark.usefixtures("undrawn")
def test_the_report_shows_them(outputs, tmp_path):
    files, skipped = make_report(outputs, tmp_path)
    names = {file.name for file in files}
    assert not skipped
    assert {"m22.csv", "m22_scenes.md", "m22_stages.tex", "m22_pipeline.png", "m22_paths.svg",
            "m22_convergence.svg", "m22_concave.csv", "m22_concave.png"} <= names  # fmt: skip
    assert not any(name.startswith("sweep_") for name in names)
