"""What of a folder of runs goes, and what stays."""

import shutil

import pytest

from gapath.pipelines.keeping import prune
from gapath.pipelines.reading.tags import Said, read_said, say
from gapath.pipelines.report import cli
from gapath.store.records import find_runs
from gapath.store.runfolder import BEFORE, LOCK, WORK, Busy, RunFolder
from gapath.store.status import Status

from ..conftest import write_status

OLD, NEW = "2020-01-01T12:00:00+00:00", "2020-02-01T12:00:00+00:00"


@pytest.fixture
def outputs(tmp_path, make_run):
    """One setting twice, the first with other code; one failed, one interrupted, one by itself."""
    place = tmp_path / "outputs"
    for key, date, planner in (
        ("old", OLD, "ga1"), ("new", NEW, "ga1"), ("failed", OLD, "ga2"), ("cut", OLD, "ga3"),
        ("only", OLD, "astar"),
    ):  # fmt: skip
        run = make_run(place, "mine", "kg18_test1", planner, key=key, date=date, log=False, n=4)
        (run / LOCK).touch()
    write_status(place / "mine" / "failed", "failed", OLD, "of itself")
    write_status(place / "mine" / "cut", "interrupted", OLD)
    (place / "mine" / "cut" / WORK / "deep").mkdir(parents=True)
    (place / "mine" / "cut" / WORK / "deep" / "run.mcap.part").write_text("part")
    (place / "mine" / "cut" / BEFORE).mkdir()
    (place / "mine" / "notes").mkdir()
    (place / "mine" / "notes" / "mine.txt").write_text("of the user's")
    (place / "mine" / "thesis.tex").write_text("of the user's")
    return place


@pytest.fixture
def report(capsys):
    def call(*words):
        code = cli.main([*map(str, words)])
        return code, *capsys.readouterr()

    return call


def left(outputs):
    return {path.name for path in (outputs / "mine").iterdir() if path.is_dir()} - {"notes"}


ALL = {"old", "new", "failed", "cut", "only"}


@pytest.mark.parametrize(
    ("words", "gone"),
    [
        ((), {"old", "failed", "cut"}),
        (("--superseded",), {"old"}),
        (("--failed",), {"failed", "cut"}),
        (("--tagged", "bad"), {"only"}),
        (("--tagged", "bad", "--superseded"), {"only", "old"}),
        (("--tagged", "none"), set()),
    ],
)
def test_what_is_chosen_is_listed_and_goes_only_if_asked(report, outputs, words, gone):
    say(outputs / "mine" / "only", lambda said: Said({"bad": ""}))
    code, text, errors = report("prune", outputs, *words)
    assert (code, errors) == (0, "") and left(outputs) == ALL
    *lines, end = text.splitlines()
    assert {line.split()[0].removeprefix("mine/") for line in lines} == gone
    assert end.startswith(f"{len(gone)} runs, ") and "--yes" in end
    code, text, errors = report("prune", outputs, *words, "--yes")
    assert (code, errors) == (0, "") and left(outputs) == ALL - gone
    assert text.splitlines()[:-1] == lines
    assert (outputs / "mine" / "notes" / "mine.txt").read_text() == "of the user's"
    assert (outputs / "mine" / "thesis.tex").exists()
    assert ("only" in read_said(outputs / "mine")) == ("only" not in gone)
    if "old" in gone:
        (line,) = [line for line in lines if "/old " in line]
        assert line.endswith("superseded by mine/new")
    assert {run.folder.name for run in find_runs(outputs)} == ALL - gone


def test_the_sizes_are_those_of_the_files(report, outputs):
    run = next(run for run in find_runs(outputs) if run.folder.name == "cut")
    everything = sum(p.lstat().st_size for p in run.folder.rglob("*") if p.is_file())
    assert prune.size_of(run) == everything > 1000


def test_what_somebody_put_beside_a_run_stays(report, outputs):
    for name in ("remarks.txt", "link"):
        (outputs / "mine" / "old" / name).symlink_to(outputs / "mine" / "thesis.tex")
    (outputs / "mine" / "failed" / "plots").mkdir()
    (outputs / "mine" / "failed" / "plots" / "a.png").write_text("a")
    code, text, _ = report("prune", outputs, "--yes")
    assert code == 0
    assert "mine/old " in text and "left in its folder, no part of it: link, remarks.txt" in text
    assert "no part of it: plots" in text
    beside = sorted(path.name for path in (outputs / "mine" / "old").iterdir())
    assert beside == ["link", "remarks.txt"]
    assert (outputs / "mine" / "failed" / "plots" / "a.png").read_text() == "a"
    assert left(outputs) == {"new", "only", "old", "failed"}
    assert {run.folder.name for run in find_runs(outputs)} == {"new", "only"}


def test_links_are_not_followed(report, outputs, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (outputs / "mine" / "failed").rename(tmp_path / "elsewhere" / "failed")
    (outputs / "mine" / "failed").symlink_to(tmp_path / "elsewhere" / "failed")
    shutil.copytree(outputs / "mine", tmp_path / "other", symlinks=True)
    (outputs / "linked").symlink_to(tmp_path / "other")
    file = tmp_path / "file.txt"
    file.write_text("of the user's")
    (outputs / "mine" / "cut" / "config.yaml").unlink()
    (outputs / "mine" / "cut" / "config.yaml").symlink_to(file)
    shutil.rmtree(outputs / "mine" / "cut" / WORK)
    (outputs / "mine" / "cut" / WORK).symlink_to(tmp_path / "other")
    code, _, errors = report("prune", outputs, "--failed", "--yes")
    assert code == 0 and errors.count(": a link\n") == 3
    assert (tmp_path / "elsewhere" / "failed" / "manifest.json").exists()
    assert (tmp_path / "other" / "cut" / "manifest.json").exists()
    assert file.read_text() == "of the user's"
    assert left(outputs) == ALL - {"cut"}


def test_a_run_at_work_stays(report, outputs):
    with RunFolder(outputs / "mine" / "cut").lock():
        code, text, errors = report("prune", outputs, "--failed", "--yes")
    assert code == 0 and "mine/failed" in text
    assert "cut" in left(outputs) and "failed" not in left(outputs)
    with RunFolder(outputs / "mine" / "old").lock():
        code, text, errors = report("prune", outputs, "--superseded", "--yes")
    assert errors == "stays mine/old: another process works on it\n" and "old" in left(outputs)


def test_a_run_that_was_done_again_meanwhile_stays(outputs):
    run = next(run for run in find_runs(outputs) if run.folder.name == "failed")
    write_status(run.folder, "done", NEW)
    assert prune.remove(run) is None and "failed" in left(outputs)


def test_what_has_a_tag_or_a_note_goes_only_by_it(report, outputs):
    say(outputs / "mine" / "old", lambda said: Said({"paper": ""}))
    say(outputs / "mine" / "failed", lambda said: Said({}, "look into this"))
    _, _, errors = report("prune", outputs, "--yes")
    assert errors.count("it has a tag or a note") == 2
    assert left(outputs) == ALL - {"cut"}
    assert report("prune", outputs, "--tagged", "paper", "--yes")[0] == 0
    assert left(outputs) == ALL - {"cut", "old"}


def test_what_goes_itself_supersedes_nothing(report, outputs):
    say(outputs / "mine" / "new", lambda said: Said({"bad": ""}))
    report("prune", outputs, "--superseded", "--tagged", "bad", "--yes")
    assert left(outputs) == ALL - {"new"}


def test_tags_that_cannot_be_read_keep_everything(report, outputs):
    (outputs / "mine" / "tags.json").write_text("{")
    code, text, errors = report("prune", outputs, "--yes")
    assert (code, text, errors.count("\n")) == (2, "", 1) and "tags.json" in errors
    assert left(outputs) == ALL


@pytest.mark.parametrize(
    ("started", "finished"),
    [(NEW, OLD), ("2999-01-01T00:00:00+00:00",) * 2, ("", ""), ("yesterday", "today")],
)
def test_where_a_clock_jumped_nothing_is_superseded(report, outputs, started, finished):
    status = Status.read(outputs / "mine" / "old")
    new = outputs / "mine" / "new"
    Status(status.state, started, finished).write(RunFolder(new))
    code, _, errors = report("prune", outputs, "--superseded", "--yes")
    assert code == 0 and left(outputs) == ALL
    assert errors.count("\n") == 1 and "by a clock that jumped: mine/new was from" in errors


def test_a_prune_that_is_cut_short_can_be_done_again(report, outputs, monkeypatch):
    """Wherever it stops, what is left is a run that can go, or no run, never half a good one."""
    for stop in range(1, 12):
        place = outputs.with_name(f"copy{stop}")
        shutil.copytree(outputs, place)
        unlink, count = type(place).unlink, [0]

        def last(path, missing_ok=False, unlink=unlink, count=count, stop=stop):
            count[0] += 1
            if count[0] == stop:
                raise OSError(5, "Input/output error", str(path))
            unlink(path, missing_ok=missing_ok)

        with monkeypatch.context() as patch:
            patch.setattr(type(place), "unlink", last)
            code, _, errors = report("prune", place, "--superseded", "--yes")
        if code:
            assert errors.count("\n") == 1 and "Input/output error" in errors
        names = {run.folder.name for run in find_runs(place)}
        if "old" in names and count[0] > 2:
            (run,) = [run for run in find_runs(place) if run.folder.name == "old"]
            assert run.state == "interrupted"
        assert report("prune", place, "--yes")[0] == 0
        assert {run.folder.name for run in find_runs(place)} == {"new", "only"}


def test_a_lock_of_a_folder_that_was_removed_holds_nothing(outputs):
    """Who waited for it while the folder was removed and made anew is not alone there."""
    folder = RunFolder(outputs / "mine" / "only")
    hold = RunFolder._hold

    def removed(self, lock):
        hold(self, lock)
        (self.path / LOCK).unlink()
        (self.path / LOCK).touch()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(RunFolder, "_hold", removed)
        with pytest.raises(Busy), folder.lock():
            pass


def test_a_folder_without_runs_is_one_line(report, tmp_path):
    code, _, errors = report("prune", tmp_path / "none")
    assert (code, errors.count("\n")) == (2, 1) and "no such folder" in errors
