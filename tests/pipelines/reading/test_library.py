"""Runs for who works in Python."""

import shutil
import sys
import warnings
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import gapath
from gapath.commands import run as cli
from gapath.events import RunFinished, RunStarted
from gapath.pipelines.reading.frame import chosen
from gapath.recorders.mcap import FILE, read_events
from gapath.store.records import MANIFEST, TRIALS, find_runs
from gapath.store.runfolder import RunFolder
from gapath.store.status import RunState, Status

MAP = "type octile\nheight 3\nwidth 5\nmap\n.....\n.@@@.\n.....\n"
COMMANDS = {
    "ga": "map=kg18_test3 planner=ga1 seed=5 trials=4 recorder=mcap name=ga",
    "astar": "map=kg18_test2 map.instance=3 planner=astar recorder=none name=astar",
    "drive": "task=drive map=kg18_map1 navigator=replan_astar trials=2 recorder=mcap name=drive",
    "file": "map=file map.path=m.map map.start=[0,0] map.target=[4,2] planner=dijkstra "
    "recorder=none name=file",
    "fewer": "map=kg18_test3 planner=ga1 seed=5 trials=2 recorder=none name=ga",
    "failed": "map=kg18_test1 planner=astar recorder=none name=failed",
}


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    top = tmp_path_factory.mktemp("library")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(top)
        (top / "m.map").write_text(MAP)
        for command in COMMANDS.values():
            patch.setattr(sys, "argv", ["gapath", *command.split()])
            cli.main()
    failed = folder_of(top / "outputs", "failed")
    status = Status.read(failed)
    replace(status, state=RunState.FAILED, message="a wheel came off").write(RunFolder(failed))
    return top / "outputs"


def folder_of(outputs, name):
    """The folder of a command's run; of two of one experiment that of most trials."""
    key = max((outputs / name).iterdir(), key=lambda path: (path / FILE).exists())
    return outputs / name / key.name


@pytest.fixture
def of(outputs):
    return lambda name: gapath.run(folder_of(outputs, name))


@pytest.fixture(scope="module")
def frame(outputs):
    with pytest.warns(UserWarning):
        return gapath.runs(outputs)


def test_runs_that_do_not_count_are_left_out_with_one_warning_that_names_them(outputs):
    failed = folder_of(outputs, "failed").name
    (fewer,) = {path.name for path in (outputs / "ga").iterdir()} - {folder_of(outputs, "ga").name}
    with pytest.warns(UserWarning, match="2 of 6 runs left out") as told:
        frame = gapath.runs(str(outputs))
    (warning,) = told
    assert f"{failed}: failed: a wheel came off" in str(warning.message)
    assert f"{fewer}: {folder_of(outputs, 'ga').name} counts" in str(warning.message)
    assert warning.filename == __file__
    assert sorted(frame["experiment"]) == ["astar", "drive", "file", "ga"]


def test_a_warning_names_few_and_counts_the_rest(outputs, tmp_path):
    source = folder_of(outputs, "failed")
    for i in range(8):
        shutil.copytree(source, tmp_path / "failed" / f"{i}{source.name}")
    with pytest.warns(UserWarning, match="8 of 8 runs left out: .*; and 3 more$"):
        frame = gapath.runs(tmp_path)
    assert len(frame) == 0 and "planner.kind" in frame.columns


def test_where_all_runs_count_nothing_is_said(outputs, tmp_path):
    shutil.copytree(outputs / "drive", tmp_path / "drive")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert gapath.runs(tmp_path)["reached"].tolist() == [1.0]


def test_a_row_has_settings_and_results_and_leads_to_its_run(outputs, frame):
    assert frame["date"].is_monotonic_increasing
    row = frame[frame["planner.kind"] == "bspline_ga"].iloc[0]
    run = gapath.run(row.folder)
    assert row.name == run.key
    assert row["planner.population"] == run.settings["planner.population"]
    assert row.success == run.trials["feasible"].mean()
    assert row.epochs == run.trials["epochs"].mean()
    shared = [name for name in run.settings if name in frame.columns]
    assert len(shared) > 10
    assert {name: row[name] for name in shared} == {name: run.settings[name] for name in shared}
    assert frame["planner.population"].dtype == "Int64"
    assert frame.loc[frame["task"] == "drive", "planner.population"].isna().all()
    assert list(chosen(frame, "planner.population >= 1 and map = 'kg18_test3'").index) == [run.key]


def test_a_run_is_named_by_its_folder_or_the_beginning_of_its_key(outputs):
    folder = folder_of(outputs, "drive")
    runs = [
        gapath.run(folder),
        gapath.run(str(folder)),
        gapath.run(outputs, folder.name),
        gapath.run(str(outputs), folder.name[:8]),
    ]
    assert {run.folder for run in runs} == {folder}
    assert repr(runs[0]) == f"gapath.run({str(folder)!r})"


def test_a_run_has_what_its_folder_has(of):
    run = of("ga")
    assert (run.status.state, run.status.message) == ("done", "")
    assert pd.read_parquet(run.folder / TRIALS)["cost"].tolist() == run.trials["cost"].tolist()
    assert set(run.trials["key"]) == {run.key}
    events = list(run.log)
    assert isinstance(events[0], RunStarted) and isinstance(events[-1], RunFinished)
    assert len(list(run.log)) == len(events) == len(list(read_events(run.folder / FILE)))


def test_a_trial_of_the_log_is_the_plan_that_was(of):
    run = of("ga")
    grid = gapath.load_map("kg18_test3")
    assert run.map.digest == grid.digest
    for number in range(4):
        plan, row = run.trial(number), run.trials.iloc[number]
        assert (plan.cost, plan.epochs, plan.feasible) == (row.cost, row.epochs, row.feasible)
        assert len(plan.evolution.best) == plan.epochs
        assert plan.lines().shape[1] == 2 and (len(plan.lines()) > 0) == plan.feasible
        axes = plan.plot(Figure().subplots())
        if plan.feasible:
            assert axes.lines[0].get_xydata().tolist() == plan.path.tolist()
    mine, first = gapath.plan(grid, planner="ga1", seed=5), run.trial()
    assert mine.path.tolist() == first.path.tolist()
    assert mine.lines().tolist() == first.lines().tolist()
    assert np.array_equal(mine.evolution.best, first.evolution.best)


def test_a_trial_of_the_log_is_the_drive_that_was(of):
    run = of("drive")
    for number in range(2):
        drive, row = run.trial(number), run.trials.iloc[number]
        assert (drive.reached, drive.steps) == (row.reached, row.steps)
        assert drive.outcome.name.lower() == row.outcome
        seen = np.unique([tuple(f) for e in drive.events for f in getattr(e, "fields", [])], axis=0)
        assert len(seen) == row.seen_fields


@pytest.mark.parametrize("name", ["ga", "astar", "drive", "file", "failed"])
def test_every_run_shows_itself(of, outputs, monkeypatch, name):
    monkeypatch.chdir(outputs.parent)  # where files are looked for that are read again
    html = of(name)._repr_html_()
    assert of(name).key in html
    assert ("data:image/png" in html) == (name != "failed")
    assert ("a wheel came off" in html) == (name == "failed")


def test_without_a_log_the_map_is_read_again_if_it_is_what_it_was(of, outputs, monkeypatch):
    monkeypatch.chdir(outputs.parent)
    run = of("astar")
    assert run.map.digest == gapath.load_map("kg18_test2", instance=3).digest
    assert (run.problem.start, run.problem.target) == (run.map.start, run.map.target)
    axes = run.plot(Figure().subplots())
    assert len(axes.images) == 1 and not axes.lines
    assert of("file").map.weights.tolist()[1] == [0.5, 1, 1, 1, 0.5]
    monkeypatch.chdir(outputs)
    with pytest.raises(gapath.InputError, match=r"m\.map"):
        of("file").map  # noqa: B018
    (outputs / "m.map").write_text(MAP.replace("@@@", "@.@"))
    with pytest.raises(gapath.InputError, match=r"map: got .*, expected the map as it was"):
        of("file").map  # noqa: B018
    assert "data:image/png" not in of("file")._repr_html_()


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (lambda out: gapath.runs(out / "none"), "none: got no such folder"),
        (lambda out: gapath.runs(out / "ga"), "got no runs"),
        (lambda out: gapath.run(out / "none"), "none: got no such folder"),
        (lambda out: gapath.run(out), "got no run, expected the folder of a run, or that of all"),
        (lambda out: gapath.run(out, "zzz"), r"got no run zzz\.\.\., expected a key"),
        (lambda out: gapath.run(out, "*"), r"got no run \*"),
        (lambda out: gapath.run(out, ""), "key: got '', expected the beginning"),
        (lambda out: gapath.run(out / "ga", "0"), "got no run 0"),
        (lambda out: gapath.run(folder_of(out, "astar")).log, "log: got none, expected one, which"),
        (lambda out: gapath.run(folder_of(out, "astar")).trial(0), "log: got none"),
        (
            lambda out: gapath.run(folder_of(out, "ga")).trial(4),
            "trial: got 4, expected an integer",
        ),
        (lambda out: gapath.run(folder_of(out, "ga")).trial(-1), "trial: got -1"),
        (lambda out: gapath.run(folder_of(out, "failed")).trials, "got failed: a wheel came off"),
        (lambda out: gapath.run(folder_of(out, "failed")).map, "got failed: a wheel came off"),
        (lambda out: gapath.run(folder_of(out, "failed")).plot(), "got failed: a wheel came off"),
    ],
)
def test_what_cannot_be_had_says_so(outputs, asked, message):
    with pytest.raises(gapath.InputError, match=message):
        asked(outputs)


def test_a_beginning_that_several_keys_have_is_refused_with_their_names(outputs, tmp_path):
    source = folder_of(outputs, "astar")
    for experiment, key in (("a", "3fa2b"), ("b", "3fa2c")):
        shutil.copytree(source, tmp_path / experiment / key)
    with pytest.raises(gapath.InputError, match="3fa2, the beginning of a/3fa2b, b/3fa2c"):
        gapath.run(tmp_path, "3fa2")
    assert gapath.run(tmp_path, "3fa2c").folder == tmp_path / "b" / "3fa2c"


@pytest.mark.parametrize("file", [TRIALS, FILE, MANIFEST])
def test_a_run_with_a_file_that_was_cut_off_is_left_out(outputs, tmp_path, file):
    shutil.copytree(folder_of(outputs, "ga"), tmp_path / "ga" / "abc")
    (tmp_path / "ga" / "abc" / file).write_bytes(b"{")
    run = gapath.run(tmp_path, "a")
    for asked in ("trials", "log", "map", "problem"):
        with pytest.raises(gapath.InputError, match=file):
            getattr(run, asked)
    assert run.status.state == "done"
    assert file in run._repr_html_()
    with pytest.warns(UserWarning, match=f"1 of 1 runs left out: abc: {file}"):
        assert len(gapath.runs(tmp_path)) == 0


@pytest.mark.parametrize("file", [TRIALS, FILE])
def test_a_file_that_was_overwritten_is_noticed_when_it_is_read(outputs, tmp_path, file):
    shutil.copytree(folder_of(outputs, "ga"), tmp_path / "ga" / "abc")
    path = tmp_path / "ga" / "abc" / file
    path.write_bytes(bytes(path.stat().st_size))
    run = gapath.run(tmp_path, "a")
    with pytest.raises(gapath.InputError, match=file):
        list(run.log if file == FILE else run.trials)
    assert run.key in run._repr_html_()


def test_every_run_that_is_found_can_be_asked_for(outputs):
    for record in find_runs(outputs):
        assert gapath.run(outputs, record.folder.name).record.folder == record.folder
