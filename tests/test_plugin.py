"""A package of one's own, installed: each of its components is found, runs, is logged and reported.

The package is ``tests/plugin``, whose files are the examples of the pages.
"""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest
from pages import again
from processes import forked

TESTS = Path(__file__).parent
ROOT = TESTS.parent
PLUGIN = TESTS / "plugin"


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Install the package beside the others, for processes that are told where."""
    folder = tmp_path_factory.mktemp("site")
    source, site = (folder / name for name in ("source", "packages"))
    shutil.copytree(PLUGIN, source)  # a build writes beside it
    options = ("--quiet", "--no-index", "--no-deps", "--no-build-isolation", "--target", str(site))
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", *options]
    done = subprocess.run([*pip, str(source)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return site


def run(site, folder, *command):
    """Run a command of gapath in a process that has the package."""
    return forked.run(command, folder, PYTHONPATH=str(site))


def succeed(*command):
    code, out, errors = run(*command)
    assert code == 0, errors
    return out


def only(folder):
    (found,) = folder.iterdir()
    return found


def test_its_planner_runs_is_recorded_and_reproduced(site, tmp_path):
    command = ("gapath", "map=kg18_test1", "planner=one_bend", "planner.tries=500",
               "recorder=[mcap,counts]", "trials=4")  # fmt: skip
    assert "found         4 (100.0 %)" in succeed(site, tmp_path, *command)
    folder = only(tmp_path / "outputs" / "plan")
    lines = (folder / "counts.txt").read_text().splitlines()
    assert lines == ["events", "RunFinished 1", "RunStarted 1", "TrialFinished 4", "TrialStarted 4"]
    assert "reproduced" in succeed(site, tmp_path, "gapath-log", "verify", folder / "run.mcap")
    manifest = json.loads((folder / "manifest.json").read_bytes())
    assert manifest["versions"]["gapath-example"] == "1.2.3"
    assert manifest["changes"] == {"planner.tries": 500}
    rows = pd.read_parquet(folder / "trials.parquet")
    assert (rows["detour"] >= 1).all()
    assert "planner.tries: 500" in succeed(
        site, tmp_path, "gapath-log", "info", folder / "run.mcap"
    )


def test_its_names_are_listed_and_told(site):
    said = {"planners": "\none_bend  ", "maps": "\nweights  ", "navigators": "\nwait_and_see  "}
    said["help one_bend"] = "planner.tries = 100\n      Fields to try, at least 1."
    environment = {**os.environ, "PYTHONPATH": str(site)}
    for words, text in said.items():
        command = [sys.executable, "-m", "gapath", *words.split()]
        assert text in subprocess.check_output(command, text=True, env=environment)


def test_its_planner_its_table_and_its_metric_stand_in_the_report_of_a_sweep(site, tmp_path):
    sweep = ("gapath", "-m", "name=bends", "map=kg18_test1,kg18_test2", "planner=one_bend",
             "planner.tries=5,50", "recorder=none", "trials=20")  # fmt: skip
    assert len(succeed(site, tmp_path, *sweep).splitlines()) == 4
    succeed(site, tmp_path, "gapath-report", "outputs")
    report = tmp_path / "outputs" / "report"
    bends = pd.read_csv(report / "bends.csv")
    assert bends[["map", "tries", "n"]].to_numpy().tolist() == [
        [name, tries, 20] for name in ("kg18_test1", "kg18_test2") for tries in (5, 50)
    ]
    assert bends["found"].max() > 0
    metrics = pd.read_csv(report / "metrics_plan.csv")
    assert metrics["detour_median"].min() >= 1
    assert "One bend" in (report / "index.html").read_text()


def test_its_population_is_logged_recorded_reproduced_and_reported(site, tmp_path):
    command = ("gapath", "map=kg18_test2", "planner=bender", "planner.epochs=12", "trials=8",
               "recorder=[mcap,rerun]")  # fmt: skip
    succeed(site, tmp_path, *command)
    folder = only(tmp_path / "outputs" / "plan")
    told = succeed(site, tmp_path, "gapath-log", "info", folder)
    assert int(re.search(r"/memetic_run +(\d)", told)[1]) > 5 and "/ga_run" not in told
    assert "reproduced" in succeed(site, tmp_path, "gapath-log", "verify", folder)
    shares = f"import gapath; print(gapath.run('{folder}').trial(1).shares())"
    there = os.environ | {"PYTHONPATH": str(site)}
    told = subprocess.check_output([sys.executable, "-c", shares], env=there, text=True)
    assert "{'first bend': " in told
    succeed(site, tmp_path, "gapath-log", "rerun", folder, "--trials", "0,1", "-o", "again")
    assert len(list((tmp_path / "again").iterdir())) == 2
    cut = tmp_path / "run.mcap.part"
    cut.write_bytes((folder / "run.mcap").read_bytes()[:-1500])
    assert "messages saved" in succeed(site, tmp_path, "gapath-log", "salvage", cut)
    succeed(site, tmp_path, "gapath-report", "outputs")
    page = tmp_path / "outputs" / "report" / "runs" / f"{folder.name}.html"
    assert "first path: first bend" in page.read_text("utf-8")


def test_its_navigator_drives(site, tmp_path):
    command = ("gapath", "task=drive", "map=kg18_map1", "navigator=wait_and_see", "recorder=mcap")
    assert "outcome       reached" in succeed(site, tmp_path, *command)
    folder = only(tmp_path / "outputs" / "drive")
    assert pd.read_parquet(folder / "trials.parquet")["stands"].tolist() == [2]
    assert "reproduced" in succeed(site, tmp_path, "gapath-log", "verify", folder / "run.mcap")


def test_its_task_runs_is_logged_recorded_and_reported(site, tmp_path):
    command = ("gapath", "task=round_trip", "map=kg18_test3", "planner=astar", "trials=2")
    assert "came back     2" in succeed(site, tmp_path, *command)
    folder = only(tmp_path / "outputs" / "round_trip")
    assert "reproduced" in succeed(site, tmp_path, "gapath-log", "verify", folder / "run.mcap")
    assert "optimal cost, one way" in succeed(
        site, tmp_path, "gapath-log", "info", folder / "run.mcap"
    )
    assert (folder / "trial-0.rrd").stat().st_size > 0
    succeed(site, tmp_path, "gapath-report", "outputs")
    overview = pd.read_csv(
        tmp_path / "outputs" / "report" / "sweep_round_trip_round_trip_others.csv"
    )
    assert overview[["place", "method", "n", "success"]].to_numpy().tolist() == [
        ["kg18_test3", "astar", 2, 1.0]
    ]
    code, _, errors = run(site, tmp_path, "gapath", "task=round_trip", "navigator=kg18")
    assert code == 2 and "navigator: got kg18 with task=round_trip" in errors


WALK = """
from dataclasses import replace
from functools import partial
from gapath.events import *
from gapath_example.round_trip import Task as RoundTrip
import numpy as np


class Task(RoundTrip):
    name, events = "walk", (TrialStarted, Stepped, DriveFinished)

    def trials(self, batch, optimum):
        for trial in super().trials(batch, optimum):
            (_, finished) = trial.events(0)
            path, number = finished.answer.path, trial.row.trial
            yield replace(trial, steps=len(path), events=partial(told, path, number, batch.seed))


def told(path, number, seed, step):
    nothing = np.empty((0, 2), dtype=np.int32)
    yield TrialStarted(step, number, seed)
    for i, (x, y) in enumerate(path.tolist()):
        yield Stepped(step + i, number, (x, y), 0, Mode.EXPLORE, nothing, nothing[:, 0], 0.0)
    steps = len(path) - 1
    yield DriveFinished(step + steps, number, Outcome.REACHED, steps, 0)
"""


def with_entry_point(site, group, line, tmp_path):
    """Copy the installed package, which has one entry point more then."""
    copy = Path(shutil.copytree(site, tmp_path / "packages"))
    (file,) = copy.glob("*.dist-info/entry_points.txt")
    names, head = file.read_text(), f"[{group}]\n"
    assert head in names
    file.write_text(names.replace(head, f"{head}{line}\n"))
    return copy


def with_task(site, name, text, tmp_path):
    """Copy the installed package, which has one task more then."""
    line = f"{name} = gapath_example.{name}"
    copy = with_entry_point(site, "gapath.tasks", line, tmp_path)
    (copy / "gapath_example" / f"{name}.py").write_text(text)
    return copy


def test_a_third_task_with_the_events_of_drives_works_everywhere(site, tmp_path):
    site = with_task(site, "walk", WALK, tmp_path)
    command = ("gapath", "task=walk", "map=kg18_test3", "planner=astar", "trials=2")
    succeed(site, tmp_path, *command)
    folder = only(tmp_path / "outputs" / "walk")
    log = folder / "run.mcap"
    assert "reproduced" in succeed(site, tmp_path, "gapath-log", "verify", log)
    assert "2 of 2: 2 reached" in succeed(site, tmp_path, "gapath-log", "info", log)
    assert (folder / "trial-0.rrd").stat().st_size > 0
    succeed(site, tmp_path, "gapath-log", "rerun", log, "--trials", "1")
    assert (folder / "trial-1.rrd").stat().st_size > 0
    succeed(site, tmp_path, "gapath-report", "outputs")
    overview = pd.read_csv(tmp_path / "outputs" / "report" / "sweep_walk_walk_others.csv")
    assert overview[["place", "n", "success"]].to_numpy().tolist() == [["kg18_test3", 2, 1.0]]


@pytest.mark.parametrize(
    ("events", "message"),
    [
        ("(TrialStarted, Lap, DriveFinished)", "walk, events: got Lap, expected classes of gapath"),
        ("(Stepped,)", "walk, events: got ['Stepped'], expected TrialStarted and one of Finished"),
    ],
)
def test_events_that_no_log_can_hold_are_refused_before_anything_is_written(
    events, message, site, tmp_path
):
    own = WALK.replace("(TrialStarted, Stepped, DriveFinished)", events)
    own = own.replace("class Task(", "class Lap(Stepped):\n    pass\n\n\nclass Task(")
    site = with_task(site, "walk", own, tmp_path)
    code, out, errors = run(site, tmp_path, "gapath", "task=walk", "planner=astar")
    assert (code, out) == (2, "")
    assert message in errors and "Traceback" not in errors
    assert not (tmp_path / "outputs").exists()
    assert run(site, tmp_path, "gapath", "planner=astar", "recorder=none")[0] == 0


def test_its_map_reader_reads(site, tmp_path):
    (tmp_path / "room.csv").write_text("0.5,0.5,0.5\n0.5,1,0.5\n0.5,0.5,0.5\n")
    command = ("gapath", "map=file", "map.path=room.csv", "map.start=[0,1]", "map.target=[2,1]",
               "planner=astar", "recorder=none")  # fmt: skip
    assert "cost          1.5" in succeed(site, tmp_path, *command)
    assert "skipped" in succeed(site, tmp_path, *command)
    text = (tmp_path / "room.csv").read_text()
    (tmp_path / "room.csv").write_text(text.replace("0.5", "0.50"))  # the same, but it is read
    assert "skipped" not in succeed(site, tmp_path, *command)
    (tmp_path / "torn.csv").write_text("0.5,0.5\n0.5\n")
    code, _, errors = run(site, tmp_path, "gapath", "map=weights", "map.path=torn.csv")
    assert code == 2 and "torn.csv" in errors


def test_an_edited_package_makes_other_runs(site, tmp_path):
    edited = Path(shutil.copytree(site, tmp_path / "edited"))
    command = ("gapath", "map=kg18_test1", "planner=one_bend", "recorder=none")
    succeed(edited, tmp_path, *command)
    assert "skipped" in succeed(edited, tmp_path, *command)
    module = edited / "gapath_example" / "one_bend.py"
    module.write_text(module.read_text() + "\n# edited\n")
    assert "skipped" not in succeed(edited, tmp_path, *command)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("broken = gapath_example.nothing", "gapath.planners: broken = gapath_example.nothing"),
        ("broken = gapath_example.detour", "gapath_example.detour: got no Planner, expected one"),
        ("grid_search = gapath_example.one_bend", "a name that gapath does not use itself"),
    ],
)
def test_a_package_that_is_wrong_is_one_clear_error(line, message, site, tmp_path):
    site = with_entry_point(site, "gapath.planners", line, tmp_path)
    (site / "gapath_example" / "conf" / "planner" / "broken.yaml").write_text("kind: broken\n")
    planner = line.partition(" ")[0].replace("grid_search", "astar")
    code, out, errors = run(site, tmp_path, "gapath", f"planner={planner}", "recorder=none")
    assert (code, out) == (2, "")
    assert message in errors and "Traceback" not in errors
    assert not (tmp_path / "outputs").exists()


@pytest.fixture(scope="module")
def outputs(site, tmp_path_factory):
    folder = tmp_path_factory.mktemp("outputs")
    succeed(site, folder, "gapath", "map=kg18_test1", "planner=astar", "recorder=none")
    return folder / "outputs"


@pytest.mark.parametrize(
    ("file", "old", "new", "command", "message"),
    [
        ("table_bends", "ORDER = 99", "", "report", ": got no ORDER, expected one with ORDER, TAS"),
        ("table_bends", "ORDER = 99", "ORDER = '9'", "report", ".ORDER: got 9, expected int | flo"),
        ("detour", "TITLE =", "NAME =", "report", ": got no TITLE, expected one with TITLE, measu"),
        ("detour", "def measure", "def count", "", ": got no measure, expected one with TITLE"),
        ("detour", "-> float", "-> str", "", ".measure, result: got <class 'str'>, expected float"),
        ("detour", "import", "1 / 0; import", "", ": got ZeroDivisionError('division by zero'), e"),
        ("detour", "import", "exit(); import", "", ": got SystemExit(None), expected a module tha"),
        ("weights", "def read", "def load", "map=weights map.path=m.csv", ".Reader: got no read,"),
        ("round_trip", "def line", "def end", "task=round_trip", ".Task: got no line, expected on"),
        ("round_trip", "Row(Row)", "Row", "task=round_trip", ".Task.row: got <class 'gapath_exa"),
        ("round_trip", '"came_back"', '"back"', "task=round_trip", ".Task.success: got back, exp"),
        ("one_bend", "def plan", "def way", "planner=one_bend", ".Planner: got no plan, expected"),
        ("one_bend", "@dataclass(frozen=True)", "", "planner=one_bend", ".Planner: got a class th"),
        ("counts", "def abort", "def stop", "recorder=counts", ".Recorder: got no abort, expected"),
    ],
)  # fmt: skip
def test_a_component_that_lacks_something_is_one_clear_error(
    file, old, new, command, message, site, outputs, tmp_path
):
    edited = Path(shutil.copytree(site, tmp_path / "edited"))
    module = edited / "gapath_example" / f"{file}.py"
    assert old in module.read_text()
    module.write_text(module.read_text().replace(old, new, 1))
    report = ("gapath-report", outputs, "-o", "report")
    planner = [] if "planner=" in command else ["planner=astar"]
    given = report if command == "report" else ("gapath", *planner, *command.split())
    code, out, errors = run(edited, tmp_path, *given)
    assert (code, out) == (2, "")
    assert f"gapath_example.{file}{message}" in errors
    assert len(errors.splitlines()) == 1, errors
    assert [path.name for path in tmp_path.iterdir()] == ["edited"]


def test_the_page_of_its_planner_does_what_it_says(site, tmp_path):
    text = (ROOT / "docs" / "how-to" / "my-planner.md").read_text("utf-8")
    page = again.Again(text, tmp_path, {"PYTHONPATH": str(site)})
    assert list(page.outputs()) == []
    assert page.failed == {}
    assert len(list(tmp_path.glob("outputs/*/*/manifest.json"))) == 1 + 4


def test_its_components_keep_the_contracts(site):
    """The tests that find every component find an installed package's, too."""
    tests = ["tests/test_contract.py", "tests/metrics", "tests/driving/test_driving.py",
             "tests/history"]  # fmt: skip
    names = "one_bend or bender or wait_and_see or detour or counts or weights or round_trip"
    command = [sys.executable, "-m", "pytest", "-n", "0", "-k", names, *tests]
    done = subprocess.run(
        command,
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout
    assert int(re.search(r"(\d+) passed", done.stdout).group(1)) >= 20


def blocks():
    """The files that the pages show: name -> content."""
    pages = ("CONTRIBUTING.md", "docs/how-to/my-planner.md")
    text = "\n".join((ROOT / page).read_text("utf-8") for page in pages)
    return dict(re.findall(r"`([\w/.]+)`:\n\n```\w+\n(.*?)```", text, re.DOTALL))


def test_the_guide_shows_the_files_of_this_package():
    shown = blocks()
    for name in ("one_bend.py", "conf/planner/one_bend.yaml", "detour.py", "pyproject.toml"):
        assert any(path.endswith(name) for path in shown), name
    for path, content in shown.items():
        assert content == (TESTS / "plugin" / path).read_text("utf-8"), path
