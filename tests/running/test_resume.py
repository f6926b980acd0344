"""A run that was cut short goes on where it was, and comes to what it comes to undisturbed."""

import hashlib
import json
import os
from dataclasses import replace

import pytest
from ending import outcome, runs_of
from test_experiment import ReadsLate, make_run

from gapath.recorders.mcap import log
from gapath.running import experiment, progress
from gapath.running.experiment import execute, run_folder
from gapath.store.runfolder import PROGRESS
from gapath.tasks.plan import Task as PlanTask

SMALL = ("map=kg18_test3", "seed=3", "recorder=mcap")
CASES = {
    "plan": ("planner=ga1", "trials=8"),
    "rows": ("planner=ga1", "trials=8", "recorder=none"),  # in place of the one of all
    "threads": ("planner=ga1", "trials=8", "threads=2"),
    "recordings": ("planner=ga1", "trials=4", "recorder=[mcap,rerun]", "recorder.rerun.trials=[1]"),
    "drive": ("task=drive", "navigator=replan_astar", "trials=4"),
    "scenario": ("task=scenario", "planner=ga1", "scenario.drawn=3", "trials=3"),
}


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch):
    """So that logs of a few trials have several."""
    monkeypatch.setattr(log, "CHUNK_MESSAGES", 5)
    monkeypatch.setattr("os.fsync", lambda file: None)


@pytest.fixture
def made(gapath, monkeypatch, tmp_path):
    """Make a run from a command line, for an output folder of its own."""

    def make(*words):
        words = {word.partition("=")[0]: word for word in (*SMALL, *words)}.values()
        (run,) = runs_of(gapath, monkeypatch, words)
        return lambda name: replace(run, output=str(tmp_path / name))

    return make


@pytest.fixture
def done(monkeypatch):
    """Numbers of the trials that are done, in this process."""
    numbers = []

    def of(task):
        trials = task.trials

        def noted(self, batch, optimum):
            for trial in trials(self, batch, optimum):
                numbers.append(trial.row.trial)
                yield trial

        monkeypatch.setattr(task, "trials", noted)
        return numbers

    return of


def cut_short(run, monkeypatch, after, how="kill"):
    """Do a run until some trials are in its journal; give how many of them are whole."""
    add, left = progress.Journal.add, [after]

    def last(journal, trial):
        add(journal, trial)
        left[0] -= 1
        if not left[0]:
            if how == "kill":
                os._exit(9)
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(progress.Journal, "add", last)
        if how == "kill":
            child = os.fork()
            if not child:
                try:
                    execute(run, "test", progress=False)
                finally:
                    os._exit(1)
            assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 9
        else:
            with pytest.raises(KeyboardInterrupt):
                execute(run, "test", progress=False)
    return progress.earlier(run_folder(run), run).count


ENDS = [(name, how) for name in CASES for how in ("kill", "interrupt")]
ENDS.remove(("recordings", "kill"))  # Rerun takes no fork


@pytest.mark.parametrize(("name", "how"), ENDS)
def test_a_run_that_was_cut_short_goes_on(name, how, made, done, monkeypatch):
    run_in = made(*CASES[name])
    plain = run_in("plain")
    execute(plain, "test", progress=False)
    expected, taken = outcome(run_folder(plain)), set()
    numbers = done(type(plain.task))
    for after in (1, plain.trials // 2 + 1, plain.trials):
        run, told = run_in(f"{how}-{after}"), []
        count = cut_short(run, monkeypatch, after, how)
        taken.add(count)
        assert count <= after and (count == after or (how == "kill" and name != "rows"))
        numbers.clear()
        execution = execute(run, "test", progress=False, tell=told.append)
        assert len(execution.rows["trial"]) == plain.trials
        assert outcome(run_folder(run)) == expected
        assert numbers == list(range(max(count - 1, 0), plain.trials))  # the last one once more
        assert [line.rpartition(": ")[2] for line in told] == (
            [f"goes on after trial {count - 1}, {count} of {plain.trials} are done"] * bool(count)
        )
    assert len(taken) > 1


def test_a_run_that_is_cut_short_time_and_again_never_goes_back(made, done, monkeypatch):
    run_in = made(*CASES["plan"])
    execute(run_in("plain"), "test", progress=False)
    run, reached = run_in("cut"), 0
    for after in (6, 2, 3, 7, 1):  # while what was done is taken up, and after it
        count = cut_short(run, monkeypatch, after, "interrupt")
        assert count == max(reached, after)
        reached = count
    numbers = done(PlanTask)
    execute(run, "test", progress=False)
    assert numbers == [6, 7] and outcome(run_folder(run)) == outcome(run_folder(run_in("plain")))


@pytest.mark.parametrize("whole_before", [False, True])
def test_force_takes_up_only_what_force_has_done(whole_before, made, done, monkeypatch):
    run = made(*CASES["rows"])("cut")
    forced, numbers = replace(run, force=True), done(PlanTask)

    def firsts(each, after):
        numbers.clear()
        cut_short(each, monkeypatch, after, "interrupt")
        return numbers[0]

    if whole_before:
        execute(run, "test", progress=False)
    else:
        assert (firsts(run, 4), firsts(forced, 2)) == (0, 0)
    assert (firsts(forced, 3), firsts(forced, 5)) == (0 if whole_before else 1, 2)
    numbers.clear()
    state = execute(run, "test", progress=False).state
    assert (state, numbers) == (("skipped", []) if whole_before else ("done", [4, 5, 6, 7]))
    numbers.clear()
    execute(forced, "test", progress=False)
    assert numbers == ([4, 5, 6, 7] if whole_before else [*range(8)])
    assert outcome(run_folder(run))


def test_with_recordings_alone_all_is_done_anew(made, done, monkeypatch):
    run_in = made(*CASES["recordings"], "recorder=rerun")
    execute(run_in("plain"), "test", progress=False)
    run, numbers = run_in("cut"), done(PlanTask)
    assert cut_short(run, monkeypatch, 3, "interrupt") == 0
    numbers.clear()
    execute(run, "test", progress=False)
    assert numbers == [0, 1, 2, 3] and outcome(run_folder(run)) == outcome(
        run_folder(run_in("plain"))
    )


def changed(data):
    """A file with a bit flipped here and there, cut, longer, or with a line doubled."""
    for place in range(3, len(data), max(len(data) // 20, 1)):
        altered = bytearray(data)
        altered[place] ^= 1 << place % 8
        yield bytes(altered)
    yield from (data[: len(data) // 2], b"", data + b"\n", data + data)


@pytest.mark.parametrize("name", [PROGRESS, "run.mcap.part"])
def test_what_is_damaged_is_done_anew(name, made, done, monkeypatch):
    run_in = made("planner=astar", "trials=5")
    execute(run_in("plain"), "test", progress=False)
    expected, run = outcome(run_folder(run_in("plain"))), run_in("cut")
    counts = set()
    cut_short(run, monkeypatch, 4, "interrupt")
    work = run_folder(run).work.path
    kept = {path.name: path.read_bytes() for path in work.iterdir()}
    numbers = done(PlanTask)
    for data in changed(kept[name]):
        if not work.exists():
            work.mkdir()
            for path in work.parent.glob("*.json"):
                path.unlink()
        for each, content in (kept | {name: data}).items():
            (work / each).write_bytes(content)
        numbers.clear()
        execute(run, "test", progress=False)
        assert outcome(run_folder(run)) == expected
        assert numbers[-1] == 4 and numbers == sorted(set(numbers))
        counts.add(numbers[0])
    assert min(counts) == 0 < max(counts) <= 3


def test_a_last_trial_that_comes_to_something_else_takes_up_nothing(made, done, monkeypatch):
    run = made(*CASES["rows"])("cut")
    cut_short(run, monkeypatch, 5, "interrupt")
    path = run_folder(run).work.path / PROGRESS
    lines, chain = path.read_bytes().splitlines(), hashlib.sha256()
    texts = [line.partition(b" ")[2] for line in lines]
    found, steps, *rest = json.loads(texts[-1])
    texts[-1] = json.dumps([found, steps + 1, *rest]).encode()
    altered = b""
    for text in texts:  # its checksums are right
        chain.update(text + b"\n")
        altered += chain.hexdigest()[:16].encode() + b" " + text + b"\n"
    path.write_bytes(altered)
    assert progress.earlier(run_folder(run), run).count == 5
    numbers = done(PlanTask)
    assert len(execute(run, "test", progress=False).rows["trial"]) == 8
    assert numbers == [4, *range(8)] and not run_folder(run).before.path.exists()


@pytest.mark.parametrize("edited", [False, True])
def test_a_file_that_was_read_meanwhile_and_edited_takes_up_nothing(
    edited, tmp_path, done, monkeypatch
):
    path = tmp_path / "late.txt"
    path.write_text("1")
    run = make_run(tmp_path / "out", trials=5)
    run = replace(run, task=PlanTask(ReadsLate(path)))
    assert cut_short(run, monkeypatch, 4, "interrupt") == 4
    if edited:
        path.write_text("2")
    numbers = done(PlanTask)
    execution = execute(run, "test", progress=False)
    assert numbers[0] == (0 if edited else 3)
    late = experiment.Manifest.read(execution.folder).late_inputs
    assert late == {str(path): hashlib.sha256(path.read_bytes()).hexdigest()}


def test_other_versions_take_up_nothing(made, done, monkeypatch):
    run = made(*CASES["rows"])("cut")
    cut_short(run, monkeypatch, 5, "interrupt")
    monkeypatch.setattr(progress, "versions", lambda: {"numpy": "3.0"})
    assert not progress.earlier(run_folder(run), run).count


def test_the_command_says_in_a_line_that_it_goes_on(gapath, monkeypatch):
    words = (*SMALL, "planner=astar", "trials=3")
    with monkeypatch.context() as patch:
        patch.setattr(progress.Journal, "close", lambda journal: 1 / 0)
        assert gapath(*words)[0] == 1
    code, out, err = gapath(*words)
    assert code == 0 and "trials        3" in out
    assert err == "gapath: kg18_test3 astar: goes on after trial 2, 3 of 3 are done\n"
