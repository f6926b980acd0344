"""Start and target in metres: the same run as in fields, on any map and for any yaw."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from test_config import run_of

from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.running import posing
from gapath.store.keys import run_key

YAML = (
    "image: m.png\nresolution: {}\norigin: {}\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
)


@pytest.fixture
def hall(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    picture = np.full((6, 10), 254, dtype=np.uint8)
    picture[2, 3] = 0
    Image.fromarray(picture).save("m.png")
    (tmp_path / "m.yaml").write_text(YAML.format(0.5, [-1.0, 2.0, 0.0]))


@pytest.mark.parametrize("kind", ["file", "rosmap"])
def test_metres_and_fields_are_one_run(kind, hall):
    """By hand: (-0.75 + 1) / 0.5 = 0.5 lies in column 0, (2.1 - 2) / 0.5 in the last row."""
    base = [f"map={kind}", "map.path=m.yaml"]
    fields = run_of(*base, "map.start=[0,5]", "map.target=[9,0]")
    metres = run_of(*base, "map.start=[-0.75m,2.1m]", "map.target=[3.9m,4.75m]")
    mixed = run_of(*base, "map.start=[0,5]", "map.target=['+3.9m',475e-2m]")
    keys = {run_key(run.settings, run.problem, run.inputs) for run in (fields, metres, mixed)}
    assert len(keys) == 1
    assert metres.settings["map.start[1]"] == 5


@given(
    st.tuples(*[st.floats(-5, 5)] * 2, st.floats(-7, 7)),
    st.floats(0.01, 3), st.integers(0, 8), st.integers(0, 4),
)  # fmt: skip
def test_the_centre_of_a_field_is_told_back(origin, resolution, x, y):
    grid = GridMap("m", np.full((5, 9), 0.5), resolution=resolution, origin=origin)
    u, v = grid.to_metres(np.array([(x, y)], dtype=np.int32))[0].tolist()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(posing, "build", lambda *_: type("Reader", (), {"read": lambda self: grid})())
        given_, told = {"start": [f"{u!r}m", f"{v!r}m"], "target": None, "x": 1}, [x, y]
        assert posing.in_fields(given_) == {**given_, "start": told}


BAD = {
    "no unit": ("[1.05,3.95]", "map.start: got [1.05,3.95], expected a field, two integers"),
    "one unit": ("[1m,3]", "map.start: got [1m,3], expected a field, two integers"),
    "one number": ("[1m]", "map.start: got [1m], expected a field, two integers"),
    "a word": ("[a,b]", "map.start: got [a,b], expected a field, two integers"),
    "no number": ("[nanm,1m]", "map.start: got [nanm,1m], expected a field, two integers"),
    "another unit": ("[1cm,1cm]", "map.start: got [1cm,1cm], expected a field, two integers"),
    "endless": ("[1e999m,1m]", "map.start: got [1e999m,1m], expected a field, two integers"),
    "beyond": (
        "[99m,3m]",
        "map.start: got [99m,3m], expected a point of the map, whose lower left field is at "
        "[-0.75, 2.25] m, its upper right at [3.75, 4.75] m",
    ),
    "blocked": (
        "[0.6m,3.6m]",
        "map.start: got [3, 2], an obstacle, expected a free field; the nearest is [3, 1], "
        "in metres [0.75m,4.25m]",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("start", "message"), BAD.values(), ids=BAD)
def test_a_point_that_is_none_is_refused(start, message, hall):
    with pytest.raises(InputError) as error:
        run_of("map=rosmap", "map.path=m.yaml", f"map.start={start}", "map.target=[9,0]")
    assert str(error.value).startswith(message)
