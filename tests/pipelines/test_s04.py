import math

import numpy as np
import pandas as pd
import pytest

from gapath.components import build
from gapath.discovery import yaml_values
from gapath.errors import InputError
from gapath.pipelines.numbers.statistics import wilson
from gapath.pipelines.papers.s04 import MAPS, RUNS, SUCCESSES, paper_successes
from gapath.pipelines.reading import logs
from gapath.pipelines.s04 import figure_paths as figure_s04_paths
from gapath.pipelines.s04 import table1 as table_s04
from gapath.pipelines.s04 import table_sweep as table_s04_sweep
from gapath.pipelines.s04.runs import other_changes, planner_of, with_form
from gapath.problem import CornerCutting, Problem
from gapath.recorders import mcap
from gapath.running.config import Run
from gapath.running.experiment import execute
from gapath.running.naming import Method
from gapath.store.records import find_runs
from gapath.store.settings import nested
from gapath.tasks.plan import Task as PlanTask

from .conftest import collect, record_of
from .synthetic import plan_settings

PERCENT = {  # as the paper prints them, by search space
    1: (100, 93.3, 93.3), 2: (0, 86.7, 100), 3: (73, 86.7, 100), 4: (53, 80, 100),
    5: (0, 100, 100), 6: (0, 20, 100), 7: (0, 0, 86.7), 8: (0, 0, 73.3),
}  # fmt: skip


def tried(preset, **given):
    """Make what is known of a run; its key says what it tries."""
    changes = {f"planner.{name}": value for name, value in given.items()}
    if "corner_cutting" in given:
        changes["corner_cutting"] = changes.pop("planner.corner_cutting")
    return record_of(preset, f"{preset} {changes}", changes=changes)


def trials(run, found, of, **columns):
    frame = pd.DataFrame({"feasible": [i < found for i in range(of)], "trial": range(of)})
    defaults = {
        "map": "s04_sp07", "map_source": "reconstructed", "planner": run.known.method, "seed": 0,
        "plan_time_s": 0.5, "optimality_ratio": math.nan, "length_ratio": math.nan,
        "evaluations": 200, "epochs": 4, "key": run.folder.name,
    }  # fmt: skip
    return frame.assign(**defaults | columns)


def joined(counts):
    """Give the trials of runs and the runs, from (run, found, of)."""
    return pd.concat([trials(*count) for count in counts]), [run for run, _, _ in counts]


def test_the_papers_percentages_are_counts_of_fifteen_runs():
    for number, percentages in PERCENT.items():
        for count, percent in zip(SUCCESSES[f"s04_sp{number:02d}"], percentages, strict=True):
            assert 100 * count / RUNS == pytest.approx(percent, abs=0.4)
    assert sorted(SUCCESSES) == sorted(MAPS)
    assert paper_successes("s04_sp06", tried("hermanu", population=50).known.preset) == 3
    assert paper_successes("s04_sp06", "astar") is None
    assert paper_successes("kg18_test1", "sedighi") is None


def test_a_cell_worked_by_hand():
    long = tried("sedighi", corner_cutting="no_diagonals")
    short = tried("sedighi", corner_cutting="no_diagonals", stop_when_feasible=True)
    frame, runs = joined([(long, 6, 15), (short, 50, 100)])
    frame.loc[frame["key"] == long.folder.name, "epochs"] = 1000
    (row,) = table_s04.summarise_cells(with_form(frame, runs)).to_dict("records")
    assert (row["planner"], row["n"], row["found"], row["success"]) == ("sedighi", 100, 50, 0.5)
    assert (row["few_n"], row["few_found"], row["paper"]) == (15, 6, 13)
    assert (row["paper_low"], row["paper_high"]) == wilson(13 / 15, 15)
    assert row["found_epochs_median"] == 4  # of the seeds
    assert not row["inside"]  # 50 % lies below 62 %
    assert not row["paper_inside"]  # 86.7 % lies above 64 %
    section = table_s04.section(frame, runs)
    (shown,) = section.tables[0].shown.to_dict("records")
    assert shown["Search space"] == "SPSet07 (reconstructed)"
    assert (shown["Paper, %"], shown["Runs: at the end, %"], shown["Seeds: found, %"]) == (
        "86.7",
        "40",
        "50",
    )
    assert (shown["Paper in runs'"], shown["Seeds in paper's"]) == ("no", "no")
    assert "0 of 1 cells" in section.remarks[0] and "SPSet07 (50 %)" in section.remarks[0]
    assert "0 of the 1 in which the paper has more than 0 %" in section.remarks[0]
    assert "In 0 of 1 cells the paper's rate lies" in section.remarks[1]


def test_a_cell_that_agrees_and_seeds_alone():
    run = tried("sedighi", stop_when_feasible=True)
    section = table_s04.section(trials(run, 80, 100), [run])
    (shown,) = section.tables[0].shown.to_dict("records")
    assert shown["Seeds in paper's"] == "yes"
    assert shown["Runs: at the end, %"] == shown["Paper in runs'"] == "\N{EN DASH}"
    assert "1 of 1 cells lie in the paper's interval, 1 of the 1" in section.remarks[0]


def test_long_runs_alone():
    run = tried("sedighi")
    section = table_s04.section(trials(run, 14, 15), [run])
    (shown,) = section.tables[0].shown.to_dict("records")
    assert (shown["Runs: at the end, %"], shown["Paper in runs'"]) == ("93.3", "yes")
    assert shown["Seeds: found, %"] == shown["Seeds in paper's"] == "\N{EN DASH}"
    assert "In 1 of 1 cells" in section.remarks[0]


def test_other_settings_are_cells_of_their_own():
    usual = tried("sedighi", corner_cutting="no_diagonals", stop_when_feasible=True)
    short = tried("sedighi", population=50, stop_when_feasible=True)
    long = tried("sedighi", population=50)
    frame, runs = joined([(usual, 80, 100), (short, 10, 100), (long, 1, 15)])
    rows = table_s04.summarise_cells(with_form(frame, runs))
    assert list(rows["planner"]) == ["sedighi", "sedighi[population=50]"]
    assert list(rows["found"]) == [80, 10]
    assert rows["few_n"].fillna(0).tolist() == [0, 15]


def test_a_path_that_was_found_and_lost_is_counted():
    first, last = tried("sedighi", stop_when_feasible=True), tried("sedighi")
    frame = with_form(*joined([(first, 10, 20), (last, 8, 15)]))
    assert table_s04.lost(frame) == (2, 10)
    assert table_s04.lost(frame[frame["short"]]) == (0, 0)


def test_what_the_experiment_sets_itself_is_no_other_setting():
    run = tried("sedighi", corner_cutting="no_diagonals", stop_when_feasible=True, population=50)
    assert other_changes(run) == {"planner.population": 50}
    assert planner_of(run) == "sedighi[population=50]"
    other = tried("sedighi", corner_cutting="forbid")  # not what it sets
    assert other_changes(other) == {"corner_cutting": "forbid"}
    assert planner_of(tried("geisler")) == "geisler"


def test_a_swept_setting_is_read_from_the_settings():
    plain = yaml_values("planner", "sedighi")
    swept = table_s04_sweep.swept_settings
    run = tried("hermanu", corner_cutting="no_diagonals", mutation_probability=0.005, population=50)
    assert run.known.preset == "hermanu"
    assert swept(run) == {
        "population": 50,
        "mutation_probability": 0.005,
        "crossover_probability": plain["crossover_probability"],
    }
    assert swept(tried("geisler"))["population"] == plain["population"]
    assert swept(tried("sedighi", turns_weight=1)) is None
    assert swept(tried("astar")) is None
    older = tried("sedighi")
    vars(older)["settings"] = older.settings | {"planner.population": 7}  # its YAML was another
    assert swept(older)["population"] == 7


def test_the_nearest_setting_comes_first():
    def sized(preset, population):
        return tried(preset, population=population)

    frame, runs = joined(
        [
            (sized("sedighi", 50), 20, 50),  # misses 62.1 % by 22.1 points
            (sized("sedighi", 100), 40, 50),
            (sized("sedighi", 300), 50, 50),  # 96.3 % by 3.7
            (sized("hermanu", 50), 0, 50),
            (sized("hermanu", 100), 0, 50),
            (sized("hermanu", 300), 0, 50),
        ]
    )
    rows = table_s04_sweep.rate_settings(table_s04_sweep.rate_cells(frame, runs))
    assert list(rows["population"]) == [100, 300, 50]
    assert list(rows["inside"]) == [2, 1, 1]
    low, high = wilson(13 / 15, 15)
    assert list(rows["off"]) == pytest.approx([0, 1 - high, low - 0.4])
    section = table_s04_sweep.section(frame, runs)
    assert "population 100" in section.remarks[0] and "2 of 2 cells" in section.remarks[0]
    (figure,) = section.figures  # only what was varied
    assert figure.name == "s04_sweep_population" and figure.png.startswith(b"\x89PNG")
    assert "50 runs" in section.remarks[1]
    astar = tried("astar")
    assert table_s04_sweep.section(trials(astar, 5, 5), [astar]) is None
    other = tried("sedighi", turns_weight=1)
    both = pd.concat([frame, trials(other, 5, 5)]), [*runs, other]
    assert table_s04_sweep.section(*both).skipped == (
        ("sedighi[turns_weight=1]", "differs in a setting that is not swept"),
    )


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    """Real runs, few generations: S04's planner finds a path on SPSet03, Hermanu's none on 07."""
    folder = tmp_path_factory.mktemp("s04")
    for name, planner in (("s04_sp03", "sedighi"), ("s04_sp07", "hermanu")):
        grid = build("map", yaml_values("map", name), "map").read()
        problem = Problem(grid, grid.start, grid.target, CornerCutting.NO_DIAGONALS)
        settings = plan_settings(planner, {"max_epochs": 40})
        task = PlanTask(build("planner", nested(settings)["planner"], "planner"))
        log = [mcap.Recorder(step_s=0.1)]
        execute(
            Run(
                "s04_table1", Method(planner), problem, task, log, 0, 3, settings, str(folder),
                False,
            ),
            "test",
            progress=False,
        )  # fmt: skip
    return folder


def test_the_best_path_of_a_run_is_free_and_has_the_fewest_turns(outputs):
    frame = collect(outputs).trials["plan"]
    for run in find_runs(outputs):
        best = figure_s04_paths.read_best(run)
        mine = frame[frame["map"] == run.known.map]
        hit = figure_s04_paths.collisions(best.start, best.path)
        assert (len(hit) == 0) == mine["feasible"].any()
        if not len(hit):
            steps = best.path[1:] - best.path[:-1]
            turns = (steps[1:] != steps[:-1]).any(axis=1).sum()
            assert turns == mine.loc[mine["feasible"], "turns"].min()


def test_collisions_are_obstacles_and_what_lies_outside(outputs):
    (start,) = (
        figure_s04_paths.read_best(run).start
        for run in find_runs(outputs)
        if run.known.map == "s04_sp07"
    )
    path = np.array([[-1, 0], [0, 0], [0, 2], [9, 10], [9, 9]])
    assert figure_s04_paths.collisions(start, path).tolist() == [[-1, 0], [0, 2], [9, 10]]


def test_search_spaces_are_drawn_from_logs(outputs, tmp_path):
    frame, runs = collect(outputs).trials["plan"], find_runs(outputs)
    section = figure_s04_paths.section(frame, runs)
    (figure,) = section.figures
    assert "SPSet07, Hermanu 2002" in figure.alt and "fields in obstacles" in figure.alt
    assert "SPSet03, Sedighi 2004: free" in figure.alt
    assert figure.png.startswith(b"\x89PNG")
    assert figure_s04_paths.section(frame, []) is None


def test_a_log_that_cannot_be_read_is_named(outputs, monkeypatch):
    def broken(path):
        raise InputError(path, "damaged", "a whole log")

    monkeypatch.setattr(logs, "read_sound", broken)
    section = figure_s04_paths.section(collect(outputs).trials["plan"], find_runs(outputs))
    assert len(section.skipped) == 2 and not section.figures
