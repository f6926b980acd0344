import os
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from gapath.errors import InputError
from gapath.mapio.rosmap import Description, Reader, occupancy, read_description

DATA = Path(os.environ.get("GAPATH_DATA", Path(__file__).parents[3] / "shared" / "data"))
READER = Reader("", start=None, target=None, free_weight=0.5, unknown="obstacle")
GOOD = {
    "image": "m.pgm",
    "resolution": "0.05",
    "origin": "[-1.0, 2.0, 0.5]",
    "negate": "0",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
}
# black, just above and just below the thresholds 0.65 and 0.196, map_saver's unknown, free
GREY = np.array([[0, 89, 90], [205, 206, 254]], dtype=np.uint8)


def save(folder: Path, pixels: np.ndarray = GREY, **keys: str) -> str:
    content = GOOD | keys
    path = folder / "m.yaml"
    path.write_text("".join(f"{key}: {value}\n" for key, value in content.items()))
    Image.fromarray(pixels).save(folder / content["image"])
    return str(path)


@pytest.mark.parametrize(
    ("keys", "unknown", "weights"),
    [
        ({}, "obstacle", [[1, 1, 1], [1, 0.5, 0.5]]),
        ({}, "free", [[1, 1, 0.5], [0.5, 0.5, 0.5]]),
        ({}, 0.75, [[1, 1, 0.75], [0.75, 0.5, 0.5]]),
        ({"negate": "true"}, 0.75, [[0.5, 0.75, 0.75], [1, 1, 1]]),
        ({"mode": "scale"}, 0.75, [[1, 1, 0.995], [0.5, 0.5, 0.5]]),
        ({"mode": "raw"}, 0.75, [[0.5, 0.945, 0.95], [0.75, 0.75, 0.75]]),
        ({"mode": "raw", "negate": "1"}, 0, [[0.5, 0.945, 0.95], [0, 0, 0]]),
    ],
)
def test_modes(tmp_path, keys, unknown, weights):
    grid = replace(READER, path=save(tmp_path, **keys), unknown=unknown, start=[2, 1]).read()
    np.testing.assert_allclose(grid.weights, weights, rtol=0, atol=1e-15)
    assert (grid.obstacles == (np.array(weights) == 1)).all()
    assert (grid.name, grid.source, grid.start, grid.target) == ("m", "rosmap", (2, 1), None)
    assert (grid.resolution, grid.origin) == (0.05, (-1.0, 2.0, 0.5))


def test_top_row_lies_highest_in_metres(tmp_path):
    path = save(tmp_path, origin="[10, 20, 0]", resolution="2")
    centres = (
        replace(READER, path=path).read().to_metres(np.array([[0, 0], [2, 1]], dtype=np.int32))
    )
    assert centres.tolist() == [[11.0, 23.0], [15.0, 21.0]]


def slow_occupancy(
    description: Description, colour: tuple[int, int, int], alpha: int | None
) -> float:
    """Say what nav2's map_server makes of one pixel."""
    if description.mode == "raw":
        per_cent = round(Fraction(sum(colour), 3))
        return per_cent if per_cent <= 100 else -1
    if description.mode == "scale" and alpha is not None and alpha != 255:
        return -1
    channels = [*colour]
    if description.mode == "trinary" and alpha is not None:
        channels.append(alpha)
    shade = sum(channels) / len(channels) / 255
    p = shade if description.negate else 1 - shade
    low, high = description.free_thresh, description.occupied_thresh
    if p > high:
        return 100
    if p < low:
        return 0
    if description.mode == "trinary" or low == high:
        return -1
    return round((p - low) / (high - low) * 100)


COLOURS = st.tuples(*3 * [st.integers(0, 255)])


@given(
    st.tuples(st.floats(0, 1), st.floats(0, 1)) | st.sampled_from([(0.4, 0.4), (0, 0), (1, 0)]),
    st.sampled_from(["trinary", "scale", "raw"]),
    st.booleans(),
    st.lists(st.tuples(COLOURS, st.none() | st.integers(0, 255)), min_size=20),
)
def test_occupancy_equals_its_slow_twin(thresholds, mode, negate, pixels):
    free, occupied = thresholds
    description = Description(Path("m.png"), 1.0, (0.0, 0.0, 0.0), negate, occupied, free, mode)
    plain, with_alpha = occupancy(description, False), occupancy(description, True)
    for colour, alpha in pixels:
        at = sum(colour)
        found = plain[at, 255] if alpha is None else with_alpha[at, alpha]
        assert found == slow_occupancy(description, colour, alpha)


def test_colours_count_as_their_mean(tmp_path):
    pixels = np.array([[[254, 254, 254], [255, 255, 252], [255, 0, 0]]], dtype=np.uint8)
    for image in ("m.png", "m.ppm"):
        path = save(tmp_path, pixels, image=image)
        assert replace(READER, path=path, unknown=0.75).read().weights.tolist() == [[0.5, 0.5, 1]]
    pixels = np.array([[[50, 60, 40], [1, 1, 0], [255, 45, 3]]], dtype=np.uint8)
    weights = replace(READER, path=save(tmp_path, pixels, image="m.png", mode="raw")).read().weights
    assert weights.tolist() == [[0.75, 0.505, 1.0]]


def test_a_palette_gives_colours(tmp_path):
    image = Image.fromarray(np.array([[0, 1, 2]], dtype=np.uint8), "P")
    image.putpalette([0, 0, 0, 254, 254, 254, 255, 0, 0])
    path = save(tmp_path, image="m.png")
    image.save(tmp_path / "m.png")
    assert replace(READER, path=path).read().obstacles.tolist() == [[True, False, True]]


def test_an_image_as_text(tmp_path):
    path = save(tmp_path)
    plain = replace(READER, path=path).read()
    words = " ".join(map(str, GREY.ravel()))
    (tmp_path / "m.pgm").write_text(f"P2\n# CREATOR: map_saver\n3 2\n255\n{words}\n")
    assert replace(READER, path=path).read().digest == plain.digest


@pytest.mark.parametrize(
    ("keys", "weights"),
    [
        # occupied from p > 0.196, and free below 0.65 is what is left
        ({"occupied_thresh": "0.196", "free_thresh": "0.65"}, [[1, 1, 1], [1, 0.5, 0.5]]),
        ({"occupied_thresh": "0.65", "free_thresh": "0.65"}, [[1, 1, 0.5], [0.5, 0.5, 0.5]]),
        ({"occupied_thresh": "0", "free_thresh": "1", "mode": "Scale"}, [[1, 1, 1], [1, 1, 1]]),
        ({"occupied_thresh": "65", "free_thresh": "-9", "mode": "raw"},
         [[0.5, 0.945, 0.95], [0.75, 0.75, 0.75]]),
        ({"negate": "'0'"}, [[1, 1, 0.75], [0.75, 0.5, 0.5]]),
        ({"negate": '"1"'}, [[0.5, 0.75, 0.75], [1, 1, 1]]),
        ({"negate": "no"}, [[1, 1, 0.75], [0.75, 0.5, 0.5]]),
        ({"mode": "TRINARY"}, [[1, 1, 0.75], [0.75, 0.5, 0.5]]),
    ],
)  # fmt: skip
def test_thresholds_and_words_as_map_servers_take_them(tmp_path, keys, weights):
    grid = replace(READER, path=save(tmp_path, **keys), unknown=0.75).read()
    np.testing.assert_allclose(grid.weights, weights, rtol=0, atol=1e-15)


def test_an_absolute_image_in_the_folder(tmp_path):
    path = Path(save(tmp_path))
    path.write_text(path.read_text().replace("image: m.pgm", f"image: {tmp_path / 'm.pgm'}"))
    assert replace(READER, path=str(path)).read().cols == 3


def test_alpha(tmp_path):
    pixels = np.array([[[254, 255], [254, 0], [0, 255]]], dtype=np.uint8)
    path = save(tmp_path, pixels, image="m.png", mode="scale")
    assert replace(READER, path=path, unknown=0.75).read().weights.tolist() == [[0.5, 0.75, 1.0]]
    path = save(tmp_path, pixels, image="m.png")  # trinary: 254 with alpha 0 is 0.747 bright
    assert replace(READER, path=path, unknown=0.75).read().weights.tolist() == [[0.5, 0.75, 1.0]]


@pytest.mark.parametrize("free_weight", [0.0, 0.1, 0.3, 0.7, 0.9])
def test_only_100_per_cent_is_an_obstacle(tmp_path, free_weight):
    pixels = np.arange(101, dtype=np.uint8).reshape(1, 101)
    grid = replace(READER, path=save(tmp_path, pixels, mode="raw"), free_weight=free_weight).read()
    assert grid.obstacles.tolist() == [[False] * 100 + [True]]
    assert (np.diff(grid.weights[0]) > 0).all()


@pytest.mark.parametrize("value", ["1e-05", "'0.05'", "5E-2", "1"])
def test_numbers_that_yaml_takes_for_text(tmp_path, value):
    description = read_description(save(tmp_path, resolution=value, origin=f"[0, 0, {value}]"))
    assert description.resolution == description.origin[2] == float(value.strip("'"))


def test_line_ends_mark_and_unknown_keys(tmp_path):
    path = Path(save(tmp_path, map_type="occupancy"))
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\n", b"\r\n"))
    assert replace(READER, path=str(path)).read().cols == 3


LAUGHS = "&a [x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"k{i}: &{'abcdefghijk'[i + 1]} [{','.join(9 * ['*' + 'abcdefghijk'[i]])}]\n" for i in range(9)
)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("resolution", "0", "resolution: got 0.0"),
        ("resolution", "-0.05", "resolution: got -0.05"),
        ("resolution", ".nan", "resolution: got nan"),
        ("resolution", ".inf", "resolution: got inf"),
        ("resolution", "true", "resolution: got True"),
        ("resolution", "fine", "resolution: got 'fine'"),
        ("resolution", "9" * 400, "resolution: got 999"),
        ("resolution", LAUGHS, "got too many values, expected at most 10000"),
        ("resolution", None, "resolution: got nothing, expected the keys image,"),
        ("origin", "[0, 0]", "origin: got list, expected three numbers"),
        ("origin", "[0, 0, .inf]", "origin: got inf"),
        ("origin", "0", "origin: got 0"),
        ("origin", None, "origin: got nothing"),
        ("negate", "2", "negate: got 2, expected 0 or 1"),
        ("negate", "[]", "negate: got list"),
        ("negate", "1.0", "negate: got 1.0, expected 0 or 1"),
        ("more", "&a {b: *a}", "got too many values"),
        ("more", "*a", "no YAML"),
        ("mode", "{<<: " + 40 * "{<<: " + 41 * "}", "got too many nested"),
        ("negate", None, "negate: got nothing"),
        ("free_thresh", "-0.1", "free_thresh: got -0.1, expected a number from 0 to 1"),
        ("occupied_thresh", "65", "occupied_thresh: got 65.0, expected a number from 0 to 1"),
        ("occupied_thresh", ".nan", "occupied_thresh: got nan"),
        ("occupied_thresh", None, "occupied_thresh: got nothing"),
        ("mode", "ternary", "mode: got 'ternary', expected one of trinary, scale, raw"),
        ("mode", "{}", "mode: got dict"),
        ("image", None, "image: got nothing"),
        ("image", "''", "image: got ''"),
        ("image", "7", "image: got 7"),
        ("image", "missing.pgm", "image: got missing.pgm, which is no file"),
        ("image", ".", "image: got ., which is no file"),
        ("image", "/etc/passwd", "image: got /etc/passwd, expected a file in the folder"),
        ("image", "C:\\m.pgm", "image: got C:\\m.pgm, which is no file"),
        ("image", "../outside.pgm", "image: got ../outside.pgm, expected a file in the folder"),
        ("image", "link.pgm", "image: got link.pgm, expected a file in the folder"),
        ("image", "ring.pgm", "image: got"),
        ("image", "x" * 300, "image: got"),
        ("image", '"a\\0b"', "image: got"),
        ("image", "m.yaml", "m.yaml: got a file that begins with"),
    ],
)
def test_bad_description(tmp_path, key, value, message):
    folder = tmp_path / "folder"
    folder.mkdir()
    path = Path(save(folder))
    (tmp_path / "outside.pgm").write_bytes((folder / "m.pgm").read_bytes())
    (folder / "link.pgm").symlink_to("../outside.pgm")
    (folder / "ring.pgm").symlink_to("ring.pgm")
    content = {k: v for k, v in (GOOD | {key: value}).items() if v is not None}
    path.write_text("".join(f"{k}: {v}\n" for k, v in content.items()))
    with pytest.raises(InputError) as caught:
        replace(READER, path=str(path)).read()
    assert str(caught.value).startswith(str(path)) and message in str(caught.value)
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "0 bytes"),
        (b"- 1\n", "got list, expected a map_server YAML"),
        (b"hello", "got 'hello'"),
        (b"#\n", "got None"),
        (b"\xff", "UTF-8"),
        (b"a: [", "no YAML"),
        (b"a: 2020-99-99", "no YAML"),
        (b"a: \x01", "no YAML"),
        (b"a: " + b"9" * 5000, "no YAML"),
        (b"!!python/object/apply:os.getcwd []", "no YAML"),
        (b"[" * 30000, "got too many nested lists"),
        (b" " * 70000, "70000 bytes"),
    ],
)
def test_what_is_no_description(tmp_path, content, message):
    path = tmp_path / "m.yaml"
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        replace(READER, path=str(path)).read()
    assert str(caught.value).startswith(str(path)) and message in str(caught.value)


@pytest.mark.parametrize("unknown", ["maybe", "0.5", -0.1, 1.1, float("nan")])
def test_bad_unknown(unknown):
    with pytest.raises(InputError, match=r"map\.unknown: got"):
        replace(READER, unknown=unknown)


@pytest.mark.parametrize("free_weight", [1.0, -0.1, float("nan")])
def test_bad_free_weight(free_weight):
    with pytest.raises(InputError, match=r"map\.free_weight: got"):
        replace(READER, free_weight=free_weight)


def test_image_beside_a_linked_folder(tmp_path):
    (tmp_path / "real").mkdir()
    save(tmp_path / "real")
    (tmp_path / "linked").symlink_to("real")
    assert replace(READER, path=str(tmp_path / "linked" / "m.yaml")).read().cols == 3


def test_public_maps():
    paths = sorted([*DATA.glob("ros/*/*.yaml"), *DATA.glob("ros/mrpb/*/*.yaml")])
    if not paths:
        pytest.skip(f"no ROS maps in {DATA}")
    for path in paths:
        reader = replace(READER, path=str(path), unknown=0.75)
        if path.name == "testmap.yaml":
            with pytest.raises(InputError, match=r"testmap\.yaml, image: got testmap\.png"):
                reader.read()
            continue
        grid, description = reader.read(), read_description(str(path))
        raster = description.image.read_bytes()
        raster = raster[:-1] if "mrpb" in str(path) else raster
        grey = np.frombuffer(raster[-grid.weights.size :], dtype=np.uint8).reshape(
            grid.weights.shape
        )
        p = 1 - grey / 255
        assert (grid.obstacles == (p > 0.65)).all()
        assert ((grid.weights == 0.5) == (p < description.free_thresh)).all()
        assert (grid.weights[grey == 205] == 0.75).all() or description.free_thresh > 0.2
        assert grid.resolution in (0.05, 0.1)
