"""Pictures that follow one another."""

import re
import shutil
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from gapath.errors import InputError
from gapath.pictures.animation import FRAMES, Animation, chosen, growing_path

WAYS = np.array([[[0, 0], [5, 5]], [[0, 0], [5, 5]], [[0, 0], [9, 1]], [[0, 0], [9, 1]]], np.int32)


@pytest.fixture
def animation():
    return growing_path(lambda axes: axes.set(xlim=(0, 9)), (6, 10), WAYS, np.array([9.0, 9, 4, 4]))


@given(st.integers(1, 500))
def test_few_moments_are_chosen_evenly_with_both_ends(count):
    found = chosen(range(count))
    assert (found[0], found[-1]) == (0, count - 1)
    assert len(found) == min(count, FRAMES)
    assert len(chosen(range(count), 9)) == min(count, 9)
    steps = np.diff(found)
    assert len(steps) == 0 or (steps.min() >= 1 and steps.max() - steps.min() <= 1)


def test_a_path_that_grows_is_shown_whenever_it_changed():
    drawn = []
    animation = growing_path(drawn.append, (6, 10), WAYS, np.array([9.0, 9, 4, 4]))
    assert list(animation.moments) == [0, 2, 3]
    assert len(animation.frames) == 3
    (axes,) = drawn
    (line,) = axes.lines
    assert line.get_xydata().tolist() == WAYS[3].tolist()
    assert axes.get_title() == "epoch 4 of 4: fitness 4"


def test_each_moment_has_its_picture_once():
    shown = []

    def scene(axes):
        (line,) = axes.plot([], [])

        def show(moment):
            shown.append(moment)
            line.set_data([0, moment], [0, moment])

        axes.set(xlim=(0, 9), ylim=(0, 9))
        return show

    animation = Animation((10, 10), [0, 4, 9], scene)
    pictures = [np.asarray(frame.convert("RGB")) for frame in animation.frames]
    assert animation.frames is animation.frames
    assert shown == [0, 4, 9]
    dark = [(picture.min(axis=2) < 200).sum() for picture in pictures]
    assert dark[0] < dark[1] < dark[2]


@pytest.mark.parametrize("shape", [(1, 400), (400, 1), (3, 3), (1, 1)])
def test_a_map_of_any_shape_has_pictures_of_a_sane_size(shape):
    animation = growing_path(lambda axes: None, shape, WAYS, np.ones(4))
    assert all(100 < side < 700 for side in animation.frames[0].size)


def test_it_is_saved_as_a_gif_that_holds_every_picture(animation, tmp_path):
    animation.save(tmp_path / "a.GIF")
    with Image.open(tmp_path / "a.GIF") as picture:
        assert picture.n_frames == 3
        assert picture.info["duration"] == 120  # a GIF counts hundredths of a second


def test_a_page_holds_every_picture_and_needs_no_other_file(animation, tmp_path):
    animation.save(str(tmp_path / "a.html"))
    page = (tmp_path / "a.html").read_text("utf-8")
    assert len(set(re.findall(r"data:image/png;base64,[\w+/=]+", page))) == 3
    assert "http" not in re.sub(r"base64,[\w+/=]+", "", page)
    assert 'max="2"' in page


def test_it_is_saved_as_a_webp_without_loss_and_always_the_same(animation, tmp_path):
    animation.save(tmp_path / "a.webp")
    with Image.open(tmp_path / "a.webp") as picture:
        assert picture.n_frames == 3
        for number, frame in enumerate(animation.frames):
            picture.seek(number)
            shown = np.asarray(picture.convert("RGB"))
            assert np.array_equal(shown, np.asarray(frame.convert("RGB")))
    again = growing_path(
        lambda axes: axes.set(xlim=(0, 9)), (6, 10), WAYS, np.array([9.0, 9, 4, 4])
    )
    for name in ("a.webp", "a.gif"):
        animation.save(tmp_path / name)
        again.save(tmp_path / f"again-{name}")
        assert (tmp_path / name).read_bytes() == (tmp_path / f"again-{name}").read_bytes()


def test_a_film_is_made_by_ffmpeg(animation, tmp_path, monkeypatch):
    program = tmp_path / "ffmpeg"
    program.write_text(
        f"#!{sys.executable}\nimport sys\n"
        "data = sys.stdin.buffer.read()\n"
        "open(sys.argv[-1], 'wb').write(' '.join(sys.argv[1:-1]).encode() + b'|' + data)\n"
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    animation.save(tmp_path / "a.mp4")
    told, _, pictures = (tmp_path / "a.mp4").read_bytes().partition(b"|")
    width, height = animation.frames[0].size
    assert f"-s {width}x{height} -r 8 ".encode() in told
    assert len(pictures) == 3 * width * height * 3
    program.write_text("#!/bin/sh\necho no codec >&2\nexit 3\n")
    with pytest.raises(InputError, match="animation: got ffmpeg: no codec, expected one that"):
        animation.save(tmp_path / "b.mp4")


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="no ffmpeg on the path")
def test_a_film_is_always_the_same(animation, tmp_path):
    for name in ("a.mp4", "b.mp4"):
        animation.save(tmp_path / name)
    film = (tmp_path / "a.mp4").read_bytes()
    assert film == (tmp_path / "b.mp4").read_bytes()
    assert film[4:8] == b"ftyp"


def test_a_film_without_ffmpeg_is_refused(animation, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match=r"got no ffmpeg, expected ffmpeg on the path, or \.webp"):
        animation.save(tmp_path / "a.mp4")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["a.avi", "a", "none/a.gif"])
def test_other_files_are_refused(animation, tmp_path, name):
    with pytest.raises(
        InputError, match=r"animation: got .*(\.gif, \.mp4, \.html|existing folder)"
    ):
        animation.save(tmp_path / name)
    assert list(tmp_path.iterdir()) == []
