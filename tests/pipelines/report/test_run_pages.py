"""The pages of runs: what they say, where they lead to, and what is left of earlier ones."""

import os
import re
import statistics
from dataclasses import replace
from urllib.parse import unquote

import numpy as np
import pandas as pd
import pytest
from gapath_example import bender

from gapath.events import RunFinished, RunStarted
from gapath.grid import GridMap
from gapath.kernels import rng
from gapath.pipelines.numbers.text import number
from gapath.pipelines.report import stills as stills_module
from gapath.pipelines.report.found_by import found_by
from gapath.pipelines.report.report import make_report
from gapath.pipelines.report.run_pages import MOST_TRIALS, Addresses, _lines, _rows
from gapath.pipelines.report.stills import newest_logs, stills_of
from gapath.planning.shortest_path import shortest_path
from gapath.planning.simulation import TimedPlan
from gapath.problem import Problem
from gapath.recorders.mcap import FILE, Recorder
from gapath.store.records import FileEntry, find_runs, read_record
from gapath.tasks.plan import trial_events

from ..conftest import record_of, sign
from ..synthetic import make_map, make_trials
from .test_report import Page


def page_of(outputs, key, folder=None):
    files, skipped = make_report(outputs, folder or outputs / "report")
    assert skipped == []
    text = (files[-1].parent / "runs" / f"{key}.html").read_text()
    Page(text)
    return text


def cells(text):
    """The tables of names and values of a page."""
    found = re.findall(r'<tr><th scope="row">(.*?)</th><td>(.*?)</td></tr>', text)
    assert found
    return dict(found)


def test_a_page_says_what_was_run_and_what_it_came_from(tmp_path, make_run):
    run = make_run(tmp_path, "plan", "kg18_test3", "ga1", instance=2, seed=7, n=20)
    inputs = {"map_inputs": {"maps/a.map": "ab" * 32}, "late_inputs": {"late.txt": "cd" * 32}}
    sign(run, changes={"planner.population": 40, "planner.vln": None}, **inputs)
    text = page_of(tmp_path, run.name)
    said = cells(text)
    known = read_record(run).known
    found = 100 * pd.read_parquet(run / "trials.parquet")["feasible"].mean()
    assert said["state"] == "done" and said["seed"] == "7" and said["trials"] == "20"
    assert said["succeeded"] == f"{found:.1f}".removesuffix(".0") + " %"
    assert said["map"] == "Map 3, instance 2" and said["start, target"] == "(0, 0), (9, 9)"
    assert said["changed: planner.population"] == "40" and said["changed: planner.vln"] == "null"
    assert said["map&#39;s content, SHA-256"] == known.map_digest
    assert said["maps/a.map, SHA-256"] == "ab" * 32 and said["late.txt, SHA-256"] == "cd" * 32
    assert said["gapath"] == "0" and said["setting"] == known.setting
    assert said["planner.control_points"] == "4" and said["planner.clip_to_map"] == "false"
    assert f"<code>{known.command}</code>" in text
    assert f"gapath-log verify {run / FILE}" in text


@pytest.mark.parametrize("place", ["report", "elsewhere/deep", "../beside"])
def test_links_lead_to_the_files_from_wherever_the_report_lies(tmp_path, make_run, place):
    outputs = tmp_path / "my runs"
    run = make_run(outputs, "plan", "kg18_test1", "ga3", n=2)
    folder = outputs / place
    text = page_of(outputs, run.name, folder)
    links = [attrs["href"] for attrs in Page(text).all("a")]
    files = {(folder / "runs" / unquote(link)).resolve() for link in links if link[0] != "#"}
    assert {run / name for name in (FILE, "config.yaml", "trials.parquet", "status.json")} <= files
    assert all(path.is_file() for path in files)


def test_pages_of_an_earlier_report_go_but_nothing_else(tmp_path, make_run):
    first = make_run(tmp_path, "plan", "kg18_test1", "ga3", n=1, log=False)
    other = make_run(tmp_path, "plan", "kg18_test1", "ga3", seed=1, n=1, log=False)
    page_of(tmp_path, other.name)
    runs = tmp_path / "report" / "runs"
    lists = set(runs.glob("of-*.html"))
    assert len(lists) == 1
    (runs / "notes.html").write_text("<p>mine</p>")
    os.mkfifo(runs / "pipe.html")
    (runs / f"{first.name}.html").unlink()
    (runs / f"{first.name}.html").symlink_to("notes.html")
    for path in other.iterdir():
        path.unlink()
    page_of(tmp_path, first.name)
    left = {path.name for path in runs.iterdir()}
    own = {f"{first.name}.html", "index.html", "page.css", "page.js"}
    assert left == own | {"notes.html", "pipe.html"}
    assert (runs / "notes.html").read_text() == "<p>mine</p>"


def test_rows_of_the_same_runs_lead_to_one_list(tmp_path, make_run):
    keys = [
        make_run(tmp_path, "mine", "kg18_test2", "ga3", seed=seed, n=4, log=False).name
        for seed in (3, 1, 2)
    ]
    page_of(tmp_path, keys[0])
    report = tmp_path / "report"
    led = re.findall(r'href="(runs/of-\w+\.html)"', (report / "index.html").read_text())
    assert len(led) >= 2 and len(set(led)) == 1  # a section's and that of metrics
    text = (report / led[0]).read_text()
    rows = re.findall(r'<a href="(\w+)\.html">.*?<td>(\d)</td><td>4</td>', text)
    assert rows == [(keys[1], "1"), (keys[2], "2"), (keys[0], "3")]
    assert "3 runs behind a row: GA 3 on Map 2" in text
    assert (
        Page((report / "runs" / "index.html").read_text()).all("a")[-1]["href"] == f"{keys[0]}.html"
    )


def test_one_run_has_no_list():
    addresses = Addresses()
    assert addresses.of(("a b",)) == "runs/a%20b.html" and addresses.lists == {}
    assert addresses.of(("a", "b")) == addresses.of(("a", "b")) != addresses.of(("a", "c"))
    assert list(addresses.lists.values()) == [("a", "b"), ("a", "c")]


def test_trials_are_the_first_and_in_the_order_of_their_run():
    few, many = (
        make_trials(make_map("kg18_test3"), "ga1", "mine", seed, n).assign(key=key)
        for key, seed, n in (("few", 0, 3), ("many", 1, MOST_TRIALS + 50))
    )
    mixed = pd.concat([many[:100], few, many[100:]], ignore_index=True)
    lines = {key: _lines(rows).splitlines() for key, rows in _rows("plan", mixed)}
    head, *rows = lines["many"]
    names = head.split(",")
    assert names[0] == "trial" and {"status", "feasible", "epochs", "cost"} <= set(names)
    # One value a run, a seed or a map, is no column.
    assert not {"seed", "map", "planner", "key", "width", "turns"} & set(names)
    assert [int(row.split(",")[0]) for row in rows] == list(range(MOST_TRIALS))
    assert len(lines["few"]) == 1 + 3
    costs = [float(row.split(",")[names.index("cost")]) for row in rows]
    assert costs == pytest.approx(list(many["cost"][:MOST_TRIALS]))
    assert dict(_rows("plan", mixed[:0])) == {}


def test_a_genetic_algorithm_is_drawn_at_its_first_middle_and_last_epoch(tmp_path, make_run):
    run = read_record(make_run(tmp_path, "table1", "kg18_test3", "ga1", n=8))
    epochs = pd.read_parquet(run.folder / "trials.parquet")["epochs"].iloc[0]
    drawn = stills_of(run)
    captions = [still.caption for still in drawn.stills]
    wanted = sorted({1, (epochs + 1) // 2, epochs})
    assert [caption.partition(":")[0] for caption in captions[:-1]] == [
        f"Trial 0, epoch {epoch} of {epochs}" for epoch in wanted
    ]
    assert captions[-1].startswith("The first 5 trials")
    assert drawn.stills[-1].lines[0].startswith("1,6 ") and drawn.stills[-1].lines[0].endswith(
        " 22,6"
    )
    assert (drawn.cols, drawn.rows) == (24, 12)
    ends = [("S", 1, 6), ("T", 22, 6)]
    assert all(still.asked.ends == ends and still.asked.least for still in drawn.stills)


def bent(outputs, make_run, trials=9):
    """Give a run whose planner tells what found the path, and what it told."""
    run = make_run(outputs, "plan", "kg18_test2", "ga1", n=trials)
    grid = GridMap("ground", np.where(np.arange(24 * 40).reshape(24, 40) % 7, 0.5, 0.125))
    problem = Problem(grid, (2, 12), (36, 10))
    planner = bender.Planner(individuals=3, epochs=20, tries=30)
    start = RunStarted(
        "plan",
        "bender",
        "plan",
        problem,
        0,
        trials,
        {},
        {"gapath": "0"},
        shortest_path(problem).path,
        11.0,
    )
    recorder, step, told = Recorder(step_s=0.1), 0, []
    recorder.open(str(run))
    recorder.record(start)
    for trial in range(trials):
        plan = planner.plan(problem, rng.stream(8, trial))
        told.append(plan.shares())
        for event in trial_events(TimedPlan(trial, plan, 0.0), 0, step):
            recorder.record(event)
        step += plan.epochs
    recorder.record(RunFinished(step, trials, trials))
    recorder.close()
    sign(run)
    return run, told


def test_a_run_says_what_found_the_path(tmp_path, make_run):
    run, told = bent(tmp_path, make_run)
    assert stills_of(read_record(run)).shares == told  # of all nine, though five are drawn
    page = page_of(tmp_path, run.name)
    head = r'<th scope="row" class="head own"[^>]*>(.*?)</th>'
    rows = dict(re.findall(rf"{head}\s*<td[^>]*>(.*?)</td>", page))
    names = list(bender.NAMES)
    first, moved = ([each[name] for each in told] for name in (names[0], names[2]))
    final = [each[names[0]] - sum(each[name] for name in names[1:]) for each in told]
    assert statistics.median(moved) > 0
    for name, values in (("first path: first bend", first), ("path found", final),
                         ("lowered by moved vertex", moved)):  # fmt: skip
        assert rows[name].startswith(f"{number(statistics.median(values))} (")
    assert "What found the path" in page and "that tell it, 9, each" in page


def test_shares_are_told_by_hand():
    shares = [
        {"wall": 10.0, "pull": 2.0, "cross": 0.0, "none": 0.0},
        {"wall": 20.0, "pull": 2.0, "cross": 8.0, "none": 0.0},
        {"wall": 0.0, "pull": 0.0, "cross": 0.0, "none": 0.0},
    ]
    table = found_by(shares)
    assert table.data["what"].tolist() == [
        "first path: wall", "lowered by pull", "lowered by cross", "path found"
    ]  # fmt: skip
    assert table.data["cost"].tolist() == [10, 2, 0, 8]
    assert table.data["part"].tolist() == pytest.approx([1, 0.15, 0.2, 0.65])
    assert table.data["trials"].tolist() == [3, 2, 1, 3]


def test_shares_of_trials_that_began_otherwise_are_told_together():
    shares = [{"wall": 10.0, "pull": 2.0, "search": 0.0}, {"search": 6.0, "pull": 1.0, "wall": 0.0}]
    table = found_by(shares)
    assert table.data["what"].tolist() == [
        "first path: wall or search", "lowered by pull", "path found"
    ]  # fmt: skip
    assert table.data["cost"].tolist() == [8, 1.5, 6.5]


def test_a_run_that_does_not_tell_it_has_no_such_table(tmp_path, make_run):
    run = make_run(tmp_path, "table1", "kg18_test3", "ga1", n=8)
    assert stills_of(read_record(run)).shares == []
    assert "What found the path" not in page_of(tmp_path, run.name)


def test_a_drive_is_drawn_as_it_goes_on(tmp_path, make_drive_run):
    run = read_record(make_drive_run(tmp_path, "drives", "kg18_map4", "kg18", log=True, n=3))
    *steps, trails = stills_of(run).stills
    lengths = [len(still.lines[0].split()) for still in steps]
    assert lengths == sorted(set(lengths)) and len(lengths) == 3
    assert re.match(r"Trial 0, (reached|returned) after", steps[-1].caption)
    assert len(trails.lines) == 3


def test_a_log_that_cannot_be_read_is_said_to_be(tmp_path, make_run):
    run = make_run(tmp_path, "plan", "kg18_test1", "astar", n=1)
    log = run / FILE
    log.write_bytes(log.read_bytes()[:-200])
    sign(run)
    text = page_of(tmp_path, run.name)
    assert "polyline" not in text and "bytes up to the end" in text


def test_stills_are_of_the_newest_logs_that_fit(monkeypatch):
    monkeypatch.setattr(stills_module, "MOST_RUNS", 3)
    monkeypatch.setattr(stills_module, "MOST_BYTES", 100)
    runs = []
    for day, size in enumerate((10, 10, 20, 90, 60, None, 10), 1):
        run = record_of("ga1", f"run {day}")
        files = {FILE: FileEntry("", size)} if size else {}
        date = f"2026-01-0{day}T00:00:00"
        status = replace(run.status, finished=date)
        runs.append(replace(run, status=status, manifest=replace(run.known, files=files)))
    assert newest_logs(runs) == {"run 7", "run 5", "run 3"}  # 90 bytes no longer fit, 20 do


def test_a_run_without_stills_says_why(tmp_path, make_run, monkeypatch):
    bare = make_run(tmp_path, "plan", "kg18_test1", "astar", n=1, log=False)
    logged = make_run(tmp_path, "plan", "kg18_test2", "astar", n=1)
    monkeypatch.setattr(stills_module, "MOST_BYTES", 10)
    assert "the run kept no log" in page_of(tmp_path, bare.name)
    assert "drawn of the newest 100 runs" in page_of(tmp_path, logged.name)
    assert len(find_runs(tmp_path)) == 2  # the report's folder is none
