"""A disk that is full: one line, exit code 2, and the same command goes on once there is room."""

import errno
import os
import resource

import pytest

from gapath.commands import run as cli

RUN = ("map=kg18_test1", "planner=ga1", "planner.max_epochs=20", "planner.min_epochs=10", "seed=3")
ALONE = (*RUN, "recorder=mcap", "provenance=false")  # nothing larger than its log


def refused(result):
    code, text, errors = result
    assert (code, text, errors.count("\n")) == (cli.BAD_INPUT, "", 1), errors
    assert errors.startswith("gapath: ") and ", expected a place that can be written" in errors
    return errors


@pytest.fixture
def whole(gapath, tmp_path):
    """A run that had room."""
    assert gapath(*RUN, output=tmp_path / "whole")[0] == 0
    (folder,) = (tmp_path / "whole" / "plan").iterdir()
    return folder


def goes_on(gapath, tmp_path):
    code, text, errors = gapath(*RUN)
    assert (code, errors) == (0, "") and "skipped" not in text
    (folder,) = (tmp_path / "out" / "plan").iterdir()
    assert not list(folder.glob("*.part"))
    assert "skipped" in gapath(*RUN)[1]
    for path in folder.iterdir():
        path.unlink()


def test_every_file_that_does_not_fit_is_told(gapath, tmp_path, whole):
    """Limits below the size of each file; EFBIG comes in the place of ENOSPC."""
    sizes = [path.stat().st_size * 3 // 4 for path in whole.iterdir()]
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    told = set()
    for size in sorted(size for size in sizes if size > 700):  # messages need some
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
        try:
            told.add(refused(gapath(*RUN)).partition(": got ")[0].rpartition("/")[2])
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        goes_on(gapath, tmp_path)
    log = (whole / "run.mcap").stat().st_size * 3 // 4
    resource.setrlimit(resource.RLIMIT_FSIZE, (log, hard))
    try:
        told.add(refused(gapath(*ALONE)).partition(": got ")[0].rpartition("/")[2])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert told >= {"run.part, recorder mcap", "trial-0.rrd"}


def test_a_report_that_does_not_fit_is_told(gapath, tmp_path, whole, monkeypatch, capfd):
    from gapath.pipelines.report.cli import main

    def fsync(file):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("os.fsync", fsync)
    assert main([str(tmp_path / "whole")]) == 2
    (line,) = capfd.readouterr().err.splitlines()[-1:]
    assert line.startswith("gapath-report: ") and "No space left on device" in line


def test_a_planners_own_trouble_with_files_is_not_the_disks(gapath, monkeypatch):
    def fail(*given):
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), "weights.bin")

    monkeypatch.setattr("gapath.planners.bspline_ga.Planner.plan", fail)
    monkeypatch.setattr("gapath.planners.bspline_ga.Planner.plan_many", fail)
    code, _, errors = gapath(*RUN)
    assert code == cli.FAILED
    assert "FileNotFoundError: " in errors and "weights.bin" in errors and "status.json" in errors
