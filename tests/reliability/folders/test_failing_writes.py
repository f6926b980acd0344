"""Every write, sync and rename of a run fails once, or is the last thing that the process does."""

import os
import shutil
from itertools import count

import pyarrow.parquet as pq
import pytest
from scale import rounds
from small_run import calls, small_run

from gapath.commands import run as cli
from gapath.errors import InputError
from gapath.running.experiment import execute, run_folder
from gapath.store.runfolder import BEFORE, WORK
from gapath.store.status import Status
from gapath.store.whole import is_whole

STEP = rounds(3, 1)  # briefly every third call, at length each
FAULTS = ("ENOSPC", "late", "short", *rounds((), ("EIO", "EDQUOT", "EROFS")))
REASONS = ("No space left", "Input/output error", "Disk quota exceeded", "Read-only file system")


class Case:
    """A run that nobody has done, or one that is there and is done again by force."""

    def __init__(self, output, again, recorders):
        self.again = again
        self.run, self.plain = (
            small_run(output, force=force, recorders=recorders) for force in (again, False)
        )
        self.folder = run_folder(self.run)
        self.before = None
        if again:
            execute(self.plain, "test")
            self.before = self.kept()

    def prepare(self):
        if not self.again and self.folder.path.parent.exists():
            shutil.rmtree(self.folder.path.parent)

    def kept(self):
        """A whole run's log, and how long its trials took, which no two runs share."""
        assert is_whole(self.folder, self.run.settings)
        table = pq.read_table(self.folder.path / "trials.parquet")
        return (self.folder.path / "run.mcap").read_bytes(), table["plan_time_s"].to_pylist()

    @property
    def state(self):
        return Status.read(self.folder.path).state

    def goes_on(self):
        """The same command without force; the run before it, or all of the new one."""
        state = execute(self.plain, "test").state
        now = self.kept()
        left = [name for name in (WORK, BEFORE) if (self.folder.path / name).exists()]
        assert not left or now == self.before  # then it is the new run's, which may go on
        if self.again:
            assert state == "skipped"
            assert now == self.before or (now[0] == self.before[0] and now[1] != self.before[1])
            self.before = now
        return state


@pytest.fixture(params=["first", "again"])
def make_case(request, tmp_path, monkeypatch):
    monkeypatch.setattr("os.fsync", lambda file: None)  # it takes ten times as long as all else
    return lambda *recorders: Case(tmp_path, request.param == "again", recorders)


@pytest.mark.parametrize("fault", FAULTS)
def test_every_call_that_fails_is_told_in_a_line_and_the_run_goes_on(
    fault, make_case, monkeypatch, tmp_path, capsys
):
    case, told_of, tried = make_case("mcap", *rounds((), ("rerun",))), 0, 0
    for n in count(1, STEP):
        case.prepare()
        try:
            with calls(monkeypatch, tmp_path, n, fault) as told:
                execute(case.run, "test")
            case.kept()  # there already, as a folder that was made although it failed
        except InputError as error:
            told_of += 1
            assert cli.refuse(error, [], sweep=False) == 2
            line = capsys.readouterr().err
            assert line.count("\n") == 1 and str(tmp_path) in line, line
            assert any(reason in line for reason in REASONS), line
            state = case.state
            assert state in (("done",) if case.again else ("failed", "unknown", "done")), told.what
            skipped = case.goes_on() == "skipped"
            assert skipped == (state == "done"), told.what
        if told.count < n:
            break
        tried += 1
    print(f"{tried} calls, {fault}: {told_of} told in a line, all resumed")
    assert told_of >= tried - 2 and n > (6 if fault == "short" else 30)
    assert not (case.folder.path / WORK).exists()


def test_a_kill_between_two_calls_leaves_the_old_run_or_the_new_one(
    make_case, monkeypatch, tmp_path
):
    case, code, states = make_case("mcap"), 9, set()
    for n in count(1, STEP):
        case.prepare()
        child = os.fork()
        if not child:
            try:
                with calls(monkeypatch, tmp_path, n, "kill"):
                    execute(case.run, "test")
                os._exit(0)
            finally:
                os._exit(1)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        states.add(str(case.state))
        case.goes_on()
        if code != 9:
            break
    print(f"{(n - 1) // STEP} kills: nothing lost")
    assert code == 0 and n > 40
    assert states == ({"done"} if case.again else {"unknown", "interrupted", "done"})
