"""``gapath-log picture`` and ``movie``: from a log alone, always the same."""

from functools import partial

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image
from recorders.log_events import example, example_drives

from gapath.commands import log as log_cli
from gapath.commands.viewing.told import drawn, told_trial
from gapath.driving.retold import Drive
from gapath.events import DriveFinished, TrialFinished
from gapath.pictures.shown import png_of
from gapath.recorders import mcap


def call(capsys, *argv):
    code = log_cli.main([str(word) for word in argv])
    printed = capsys.readouterr()
    return code, printed.out, printed.err


def test_a_trial_of_a_log_is_what_the_library_gives(plans, drives):
    for log, events, end in (
        (plans, example(), TrialFinished),
        (drives, example_drives(), DriveFinished),
    ):
        ends = [event for event in events if isinstance(event, end)]
        told = drawn(*told_trial(log, 1, mcap.USUAL))
        if isinstance(told, Drive):
            assert told.steps == ends[1].steps
        else:
            assert told.path.tolist() == ends[1].answer.path.tolist()
            assert told.evolution.best.tolist() == pytest.approx(
                [e for e in events if getattr(e, "trial", 0) == 1][1].evolution.best, nan_ok=True
            )


def at(animation, moment, axes):
    animation.scene(axes)(moment)


def test_a_picture_is_what_the_library_draws(plans, drives, capsys):
    for log, step, moment in ((plans, 3, 2), (drives, 4, 4)):
        told = drawn(*told_trial(log, 1, mcap.USUAL))
        code, out, err = call(capsys, "picture", log, "--trial", "1")
        file = log.with_name("trial-1.png")
        assert (code, out, err) == (0, f"{file}\n", "")
        assert file.read_bytes() == png_of(told.plot)
        code, out, _ = call(capsys, "picture", log, "--trial", "1", "--step", step)
        file = log.with_name(f"trial-1-step-{step}.png")
        assert (code, out) == (0, f"{file}\n")
        assert file.read_bytes() == png_of(partial(at, told.animate(), moment))


@pytest.mark.parametrize("kind", ["webp", "gif"])
def test_a_movie_is_always_the_same(kind, plans, drives, capsys, tmp_path):
    for log in (plans, drives):
        files = [tmp_path / f"{name}.{kind}" for name in "ab"]
        for file in files:
            assert call(capsys, "movie", log, "-o", file) == (0, f"{file}\n", "")
        assert files[0].read_bytes() == files[1].read_bytes()
        with Image.open(files[0]) as movie:
            assert 1 < movie.n_frames <= 240


def test_a_movie_of_a_long_course_has_few_pictures(monkeypatch, drives, capsys):
    monkeypatch.setattr("gapath.commands.viewing.drawing._MOST", 3)
    assert call(capsys, "movie", drives)[0] == 0
    with Image.open(drives.with_name("trial-0.webp")) as movie:
        assert movie.n_frames == 3


def test_a_plan_without_epochs_has_a_picture_but_no_movie(tmp_path, capfd, gapath):
    assert gapath("map=kg18_test1", "planner=astar", "recorder=mcap")[0] == 0
    (log,) = tmp_path.glob("out/plan/*/run.mcap")
    assert call(capfd, "picture", log)[0] == 0
    code, out, err = call(capfd, "movie", log)
    assert (code, out) == (2, "")
    assert "got no history, expected the plan of a genetic algorithm" in err


def test_a_path_is_printed_in_metres(plans, drives, capsys):
    """Of maps with 0.05 and 1 m a field, the first with an origin: as the log's own paths are."""
    for log in (plans, drives):
        told = drawn(*told_trial(log, 1, mcap.USUAL))
        code, out, err = call(capsys, "path", log, "--trial", "1")
        first, *rows = out.splitlines()
        assert (code, first, err) == (0, "x,y", "")
        metres = [list(map(float, row.split(","))) for row in rows]
        expected = told.problem.map.to_metres(told.path)
        assert np.abs(np.array(metres) - expected).max() <= 1e-6 / 2 + 1e-12


def test_a_trial_without_a_path_says_so(tmp_path, capfd, gapath):
    words = ["map=kg18_test3", "planner=ga1", "planner.max_epochs=1", "recorder=mcap", "seed=0"]
    assert gapath(*words, "planner.min_epochs=1")[0] == 0
    (log,) = tmp_path.glob("out/plan/*/run.mcap")
    code, out, err = call(capfd, "path", log)
    assert (code, out) == (2, "")
    assert err == (
        "gapath-log: trial 0: got no path: the planner stopped without a feasible path, "
        "expected a trial that found one\n"
    )


def test_a_drive_says_what_its_colours_mean(drives):
    figure = Figure()
    axes = figure.subplots()
    told = drawn(*told_trial(drives, 1, mcap.USUAL))
    told.plot(axes)
    assert labels(axes) == ["the robot and its way", "obstacle", "tinted: not seen by it"]
    axes = figure.subplots()
    told.animate().scene(axes)(1)
    assert labels(axes)[1:3] == ["path that it follows", "what its sensor covers"]


def labels(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


BAD = {
    "trial": (["picture", "--trial", "9"], "trial: got 9, expected a trial of this log, 0 to 1"),
    "step": (["picture", "--step", "99"], "--step: got 99, expected step 0 to 10 of this trial"),
    "png": (["picture", "-o", "a.jpg"], "--output: got a.jpg, expected a file name .png"),
    "kind": (["movie", "-o", "a.avi"], "--output: got a.avi, expected a file name .webp, .gif"),
    "no ffmpeg": (["movie", "-o", "a.mp4"], "got no ffmpeg, expected ffmpeg on the path"),
}


@pytest.mark.parametrize(("argv", "expected"), BAD.values(), ids=BAD)
def test_bad_input_is_one_line_and_nothing_is_written(
    argv, expected, drives, capsys, monkeypatch, tmp_path
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    before = sorted(tmp_path.rglob("*"))
    code, out, err = call(capsys, argv[0], drives, *argv[1:])
    assert (code, out) == (2, "")
    assert expected in err and err.count("\n") == 1
    assert sorted(tmp_path.rglob("*")) == before
