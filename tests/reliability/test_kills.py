"""Commands killed at random moments and started again until all is whole: nothing is lost.

Most are forked from this process, which has imported everything, so that a kill costs a moment.
The long form adds processes that start and compile as those of users do.
"""

import os
import random
import shutil
import statistics
import time
from collections import Counter, defaultdict
from contextlib import suppress
from dataclasses import replace

import pyarrow.parquet as pq
import pytest
from ending import (
    INT,
    KEPT,
    KILL,
    TERM,
    WORDS,
    Forked,
    ended,
    is_watching,
    outcome,
    runs_of,
    started,
    states,
    wait,
)
from mcap.exceptions import McapError
from mcap.records import Channel, Message
from mcap.stream_reader import StreamReader
from scale import rounds

from gapath.commands import run as cli
from gapath.commands import signals
from gapath.commands.signals import watched
from gapath.recorders.mcap import FILE
from gapath.running.experiment import execute
from gapath.store.durable import part_of
from gapath.store.records import TRIALS, Manifest, read_record
from gapath.store.runfolder import PROGRESS, WORK, RunFolder
from gapath.store.status import STATUS, WHOLE, RunState
from gapath.store.whole import is_finished, is_whole
from gapath.tasks import drive, plan, scenario

WAYS = {"KILL": [KILL], "TERM": [TERM], "INT": [INT], "INT twice": [INT, INT]}
PROMISED = 0.5  # seconds, asked of half of the signals, for a process may have to wait its turn

SMALL = ["map=kg18_test1", "planner=astar", "recorder=mcap"]
GENETIC = ["map=kg18_test4", "planner=ga3"]
SHORT = {
    "sweep": ["-m", *SMALL, "seed=range(3)", "trials=150"],
    "rows": [*GENETIC, "trials=50", "recorder=none"],
}
LONG = SHORT | {
    "short trials": [*SMALL, "trials=1000"],
    "threads": [*GENETIC, "trials=40", "recorder=mcap", "threads=2"],
    "drives": ["task=drive", "map=kg18_map4", "navigator=kg18", "recorder=mcap", "trials=8"],
    "scenario": ["task=scenario", *GENETIC, "recorder=mcap", "scenario.drawn=20", "trials=5"],
}


class Toll:
    """What was seen."""

    def __init__(self):
        self.ways, self.twice, self.commands, self.seconds = Counter(), Counter(), 0, []

    @property
    def kills(self):
        return self.ways.total()

    def __str__(self):
        told = [f"{count} by {way}" for way, count in self.ways.most_common()]
        twice = [f"{count} {why}" for why, count in self.twice.most_common()]
        return (
            f"{self.kills} kills of {self.commands} commands ({', '.join(told)}): none lost, none "
            f"unequal; trials done twice: {', '.join(twice) or 'none'}; signals took "
            f"{statistics.median(self.seconds):.3f} s (median), {max(self.seconds):.3f} s at worst"
        )


class Command:
    """A command that is started on one folder of outputs again and again."""

    def __init__(self, place, start, script="gapath"):
        place.mkdir()
        self.out, self.errors, self.notes = place / "out", place / "errors", place / "notes"
        self.start, self.script, self.trials = start, script, 0

    def begun(self):
        self.notes.write_text("")
        process = self.start(self)
        wait(process, lambda: is_watching(process))
        return process

    def undisturbed(self):
        """Give what comes of it, and how long it takes."""
        process, begin = self.begun(), time.monotonic()
        wait(process, lambda: False, 600.0)
        assert process.returncode == 0, self.errors.read_text()
        seconds, found = time.monotonic() - begin, self.outcomes()
        tables = [pq.read_metadata(path / TRIALS) for path in self.folders()]
        self.trials = max((table.num_rows for table in tables), default=0)  # of a run
        shutil.rmtree(self.out, ignore_errors=True)
        return found, seconds

    def noted(self):
        """The trials that were computed since it was started, by seed."""
        numbers = defaultdict(list)
        for line in self.notes.read_text().splitlines():
            seed, trial = map(int, line.split())
            numbers[seed].append(trial)
        return numbers

    def parts(self):
        return self.out.glob(f"*/*/{WORK}")

    def folders(self):
        return {path: RunFolder(path) for path in self.out.glob("*/*/")}

    def outcomes(self):
        return {path.name: outcome(folder) for path, folder in self.folders().items()}


def note_trials(path):
    """Have this process write down each trial that it has computed, before any file says so."""
    notes = os.open(path, os.O_WRONLY | os.O_APPEND)

    def noted(trials):
        def given(task, batch, optimum):
            for trial in trials(task, batch, optimum):
                os.write(notes, f"{batch.seed} {trial.row.trial}\n".encode())
                yield trial

        return given

    for module in (plan, drive, scenario):
        module.Task.trials = noted(module.Task.trials)


def in_log(part):
    """Count the trials that are whole in a log that may be cut short; None if there is none."""
    path = next((path for path in (part / FILE, part_of(part / FILE)) if path.exists()), None)
    if path is None:
        return None
    topics, ends = {}, 0
    with path.open("rb") as file:
        try:
            for record in StreamReader(file, validate_crcs=True).records:
                if isinstance(record, Channel):
                    topics[record.id] = record.topic
                elif isinstance(record, Message):
                    ends += topics[record.channel_id] in ("/result", "/drive_end")
        except McapError:
            pass
    return ends


def in_journal(part):
    """Count the trials of which a run under way has said that they are done."""
    with suppress(FileNotFoundError):
        return max((part / PROGRESS).read_bytes().count(b"\n") - 1, 0)
    return 0


def kept(folder):
    """Count the trials that a run which was cut short has done, and those that it has whole."""
    found = [(in_journal(part), in_log(part)) for part in (folder.work.path, folder.before.path)]
    sound = [done if logged is None else min(done, logged) for done, logged in found]
    return max(done for done, _ in found), max(sound)


def at_random(process, command, length, chance):
    """Wait for a moment of a command's whole time, of its trials, or of a run's last ones."""
    when, delay = chance.choice(["any", "trials", "trials", "end"]), 0.0
    if when == "any" or not command.trials:
        delay = chance.uniform(0, length)
    elif when == "trials":
        count = chance.randrange(command.trials)
        wait(process, lambda: any(in_journal(part) > count for part in command.parts()), 600.0)
    else:
        wait(process, lambda: any((part / TRIALS).exists() for part in command.parts()), 600.0)
        delay = chance.uniform(0, 0.02)
    end = time.monotonic() + delay
    wait(process, lambda: time.monotonic() > end, 600.0)


def until_whole(command, expected, length, chance, toll, enough):
    """Kill a command and start it again until it ends by itself, or has to, and compare."""
    shutil.rmtree(command.out, ignore_errors=True)
    toll.commands += 1
    process = None
    while process is None or process.returncode:
        before = {path: (kept(folder), whole(path)) for path, folder in command.folders().items()}
        running = states(command.out).count("running")
        process = command.begun()
        if toll.kills < enough:
            at_random(process, command, length, chance)
        else:
            wait(process, lambda: False, 600.0)
        way = chance.choice([*WAYS])
        seconds = ended(process, *WAYS[way]) if process.poll() is None else 0.0
        if process.returncode:
            toll.ways[way] += 1
            if way != "KILL":
                toll.seconds.append(seconds)
        check_told(process, command, WAYS[way])
        check_states(command, WAYS[way], seconds, running)
        count_twice(command, before, toll)
    assert command.outcomes() == expected


def whole(path):
    """The status of a run that is done, with its times."""
    text = (path / STATUS).read_bytes() if (path / STATUS).exists() else b""
    return text if b'"done"' in text else None


def check_told(process, command, numbers):
    """Nothing but lines that a run goes on, and, of a signal that ended it, one line."""
    *others, last = ["", *command.errors.read_text().splitlines()]
    word = f"{command.script}: {WORDS.get(numbers[0])}{KEPT * (command.script == 'gapath')}"
    if process.returncode in (0, -KILL) or len(numbers) == 2:
        assert process.returncode in (0, -numbers[0], 128 + numbers[0])
        others += [last] * (last != word or not process.returncode)
    else:
        assert (process.returncode, last) == (128 + numbers[0], word)
    assert all(" goes on after trial " in line for line in others if line), others


def check_states(command, numbers, seconds, running):
    """What a run's files say of it is so."""
    if numbers in ([TERM], [INT]) and seconds < signals.PATIENCE:
        assert states(command.out).count("running") <= running  # left by an earlier kill
    for path, folder in command.folders().items():
        found = read_record(path)
        assert found.state in (*WHOLE, RunState.INTERRUPTED, RunState.UNKNOWN), found.fault
        if found.state in WHOLE:
            assert is_finished(folder) if found.fault else is_whole(folder, found.settings)


def count_twice(command, before, toll):
    """Of trials that were done: the last that is whole, and those whose chunk of the log is not."""
    numbers = command.noted()
    for path, ((done, sound), status) in before.items():
        again = numbers[Manifest.read(path).seed] if done or status else []
        assert not (status and again), "a finished run was done again"
        assert status in (None, whole(path))
        if again:
            assert again == [*range(max(sound - 1, 0), again[-1] + 1)]
            toll.twice["of a chunk under way"] += done - sound
            toll.twice["last ones"] += sound > 0


def tried(command, kills, chance):
    """Kill a command so many times, and give what was seen."""
    toll = Toll()
    expected, length = command.undisturbed()
    while toll.kills < kills:
        until_whole(command, expected, length, chance, toll, kills)
    return toll


@pytest.mark.parametrize("name", rounds(SHORT, LONG))
def test_forked_commands_killed_at_random_moments(name, gapath, tmp_path, monkeypatch):
    monkeypatch.setattr("os.fsync", lambda file: None)  # nothing here is about what is durable
    runs = runs_of(gapath, monkeypatch, LONG[name])
    for run in runs:
        execute(replace(run, output=str(tmp_path / "first")), "test", progress=False)  # has kernels

    def start(command):
        def work():
            with watched("gapath", KEPT):
                note_trials(command.notes)
                for run in runs:
                    execute(replace(run, output=str(command.out)), "test", False, cli.warn)

        return Forked(work, command.errors)

    toll = tried(Command(tmp_path / "killed", start), rounds(5, 150), random.Random(name))
    print(f"{name}, forked: {toll}")
    swamped = os.getloadavg()[0] > 4 * os.cpu_count()
    assert toll.seconds and (swamped or statistics.median(toll.seconds) < PROMISED)


STARTED = {
    "recordings": ["gapath", *GENETIC, "trials=60", "recorder=[mcap,rerun]"],
    "threads": ["gapath", *LONG["threads"]],
    "drives": ["gapath", *LONG["drives"]],
    "sweep": ["gapath", "-m", *SMALL, "trials=200", "seed=range(6)"],
    "cold": ["gapath", *GENETIC, "trials=20", "recorder=mcap", "seed=3"],
    "report": ["gapath-report", "OUTPUTS", "-o", "REPORT"],
    "check": ["gapath-log", "verify", "LOG"],
}


@pytest.mark.skipif(rounds(True, False), reason="takes minutes")
@pytest.mark.parametrize("name", STARTED)
def test_commands_killed_at_random_moments_since_they_start(name, gapath, tmp_path):
    outputs, (script, *words) = tmp_path / "outputs", STARTED[name]
    assert gapath(*GENETIC, "trials=60", "recorder=mcap", output=outputs)[0] == 0
    names = {"OUTPUTS": outputs, "REPORT": tmp_path / "report", "LOG": next(outputs.rglob(FILE))}
    words = [str(names.get(word, word)) for word in words]
    cold = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")} if name == "cold" else {}

    def start(command):
        own = [f"output={command.out}"] * (script == "gapath")
        return started(script, [*words, *own], command.errors, **cold)

    command = Command(tmp_path / "killed", start, script)
    print(f"{name}, started: {tried(command, 15, random.Random(name))}")
