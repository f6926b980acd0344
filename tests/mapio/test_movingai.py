import math
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from gapath.errors import InputError, printable
from gapath.grid import GridMap
from gapath.mapio.movingai import Reader, read_scenario
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Problem

DATA = Path(os.environ.get("GAPATH_DATA", Path(__file__).parents[3] / "shared" / "data"))
READER = Reader("", start=None, target=None, scenario=None, problem=0, free_weight=0.5)
MAP = "type octile\nheight 2\nwidth 7\nmap\n.GS@OTW\n@@@@@@.\n"
ROW = "3\tm.map\t7\t2\t2\t0\t6\t1\t4.41421356\n"
SCENARIO = "version 1\n" + ROW + "0\tm.map\t7\t2\t0\t0\t1\t0\t1\n"


def save(folder: Path, name: str, content: str | bytes) -> str:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return str(path)


def test_every_character_has_its_weight(tmp_path):
    path = save(tmp_path, "m.map", MAP)
    grid = replace(READER, path=path, start=[0, 0], target=[6, 1], free_weight=0.25).read()
    assert grid.weights.tolist() == [[0.25] * 3 + [1.0] * 4, [1.0] * 6 + [0.25]]
    assert (grid.name, grid.source, grid.start, grid.target) == ("m", "movingai", (0, 0), (6, 1))


@pytest.mark.parametrize(
    "text", [MAP.replace("\n", "\r\n"), "\ufeff" + MAP, MAP.rstrip("\n"), MAP + "\n\n"]
)
def test_line_ends_mark_and_blank_lines_do_not_matter(tmp_path, text):
    grid = replace(READER, path=save(tmp_path, "m.map", text)).read()
    assert grid.obstacles.tolist() == [[False] * 3 + [True] * 4, [True] * 6 + [False]]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "0 bytes"),
        (b"\xff\xfe", "byte 0xff at position 0, expected text in UTF-8"),
        ("type octile\n", "expected the lines 'type octile'"),
        (MAP.replace("octile", "hex"), "expected the lines 'type octile'"),
        (MAP.replace("height 2", "height -2"), "expected the lines"),
        (MAP.replace("height 2", "height \u0662"), "expected the lines"),
        (MAP.replace("height 2", "height 3"), "2 rows, expected 3, the header's height"),
        (MAP.replace("height 2", "height 1"), "2 rows, expected 1"),
        (MAP.replace("height 2", "height 0"), "height 0, width 7"),
        (MAP.replace("width 7", "width 999999999"), "line 5: got 7 characters"),
        (MAP.replace("@@.", "@."), "line 6: got 6 characters, expected 7"),
        (MAP.replace("GS@", "GX@"), "line 5, column 3: got 'X', expected one of . G S"),
        (MAP.replace("GS@", "G\u00e9@"), "line 5, column 3: got '\u00e9'"),
        (MAP.replace("GS@", "G\0@"), "line 5, column 3: got '\\x00'"),
    ],
)
def test_bad_map(tmp_path, content, message):
    path = save(tmp_path, "bad.map", content)
    with pytest.raises(InputError) as caught:
        replace(READER, path=path).read()
    assert str(caught.value).startswith(path) and message in str(caught.value)


def test_what_is_no_file(tmp_path):
    os.mkfifo(tmp_path / "pipe.map")
    long = tmp_path / ("x" * 300)
    for path in (tmp_path / "none.map", tmp_path, tmp_path / "pipe.map", long, "", "a\0b"):
        with pytest.raises(InputError) as caught:
            replace(READER, path=str(path)).read()
        assert str(caught.value).startswith(printable(path))


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"free_weight": 1.0}, "map.free_weight: got 1.0"),
        ({"free_weight": float("nan")}, "map.free_weight: got nan"),
        ({"free_weight": -0.1}, "map.free_weight: got -0.1"),
        ({"problem": -1}, "map.problem: got -1, expected an integer from 0 to 1000000"),
        ({"problem": 10**6 + 1}, "map.problem: got 1000001, expected an integer from 0 to 1000000"),
        ({"problem": 2}, "map.problem: got 2"),
        ({"start": [1]}, "map.start: got [1]"),
        ({"target": [1, 2, 3]}, "map.target: got [1, 2, 3]"),
    ],
)
def test_bad_settings(tmp_path, settings, message):
    path, scenario = save(tmp_path, "m.map", MAP), save(tmp_path, "m.scen", SCENARIO)
    with pytest.raises(InputError) as caught:
        replace(READER, path=path, scenario=scenario, **settings).read()
    assert message in str(caught.value)


def test_scenario_gives_start_and_target(tmp_path):
    path, scenario = save(tmp_path, "m.map", MAP), save(tmp_path, "m.scen", SCENARIO)
    reader = replace(READER, path=path, scenario=scenario)
    first, second = reader.read(), replace(reader, problem=1, target=[2, 0]).read()
    assert (first.start, first.target) == ((2, 0), (6, 1))
    assert (second.start, second.target) == ((0, 0), (2, 0))
    assert first.published_length == 4.41421356
    assert math.isnan(second.published_length)  # it is another problem's
    assert math.isnan(replace(READER, path=path).read().published_length)


def test_scenario_rows(tmp_path):
    spaced = SCENARIO.replace("1\n", "1.0\n", 1).replace("\t", "  ")
    for text in (SCENARIO, spaced, SCENARIO.replace("\n", "\r\n")):
        rows = read_scenario(save(tmp_path, "m.scen", text + "\n\n"))
        assert len(rows) == 2
        assert rows[0] == (3, "m.map", 7, 2, (2, 0), (6, 1), 4.41421356)


@pytest.mark.parametrize("folder", ["maps/dao/", "..\\maps\\", "", "./"])
def test_a_scenario_names_its_map_in_any_folder(tmp_path, folder):
    path = save(tmp_path, "m.map", MAP)
    scenario = save(tmp_path, "m.scen", SCENARIO.replace("m.map", f"{folder}m.map"))
    assert replace(READER, path=path, scenario=scenario).read().start == (2, 0)


TERRAIN = "type octile\nheight 2\nwidth 7\nmap\n.SWWTGW\n.WW.T.@\n"


@pytest.mark.parametrize(
    ("start", "passable"),
    [
        ([0, 0], ["##   # ", "#  # # "]),  # from the ground: ground and swamp
        ([1, 0], ["##   # ", "#  # # "]),
        (None, ["##   # ", "#  # # "]),
        ([2, 0], ["  ##  #", " ##    "]),  # from water: water
        ([4, 0], ["##   # ", "#  # # "]),  # trees are never passed: the start is refused later
        ([7, 0], ["##   # ", "#  # # "]),  # outside, refused later
    ],
)
def test_who_starts_on_water_stays_on_it(tmp_path, start, passable):
    path = save(tmp_path, "m.map", TERRAIN)
    grid = replace(READER, path=path, start=start).read()
    assert [
        "".join(" #"[free] for free in row) for row in (~grid.obstacles).astype(int)
    ] == passable
    if start == [4, 0]:
        with pytest.raises(InputError, match=r"map.start: got \[4, 0\], an obstacle"):
            Problem(grid, grid.start, (0, 0))


def test_the_scenario_may_start_on_water(tmp_path):
    path = save(tmp_path, "m.map", TERRAIN)
    row = "0\tm.map\t7\t2\t2\t0\t1\t1\t1.41421356\n"
    scenario = save(tmp_path, "m.scen", "version 1\n" + row)
    grid = replace(READER, path=path, scenario=scenario).read()
    assert shortest_path(Problem(grid, grid.start, grid.target)).path.tolist() == [[2, 0], [1, 1]]


def test_scenario_without_rows(tmp_path):
    assert read_scenario(save(tmp_path, "m.scen", "version 1\n")) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("version 2\n" + ROW, "line 1: got 'version 2'"),
        (ROW, "line 1"),
        ("version 1\n" + ROW.replace("\t", ","), "line 2: got 1 columns, expected 9"),
        ("version 1.0\n" + ROW.replace("\t", " ").replace("m.map ", ""), "line 2: got 8 columns"),
        ("version 1\n" + ROW + "\n" + ROW, "line 3: got 0 columns"),
        ("version 1\n" + ROW.replace("m.map", "n.map"), "row 0: got a problem on n.map, expected"),
        ("version 1\n" + ROW.replace("m.map", "m.map/n"), "row 0: got a problem on n, expected"),
        ("version 1\n" + ROW.replace("m.map", "m.MAP"), "row 0: got a problem on m.MAP, expected"),
        ("version 1\n" + ROW.replace("\t7\t2\t", "\t7\t3\t"), "row 0: got a map of 7 x 3"),
        ("version 1\n" + ROW.replace("\t2\t2\t", "\t2\t2.5\t"), "line 2: got '3\\tm.map"),
        ("version 1\n" + ROW.replace("4.41421356", "nan"), "line 2: got nan"),
        ("version 1\n" + ROW.replace("4.41421356", "-1"), "line 2: got -1.0"),
        ("version 1\n" + ROW.replace("\t7\t2\t", "\t8\t2\t"), "row 0: got a map of 8 x 2"),
    ],
)
def test_bad_scenario(tmp_path, text, message):
    path, scenario = save(tmp_path, "m.map", MAP), save(tmp_path, "bad.scen", text)
    with pytest.raises(InputError) as caught:
        replace(READER, path=path, scenario=scenario).read()
    assert str(caught.value).startswith(scenario) and message in str(caught.value)


def write_map(obstacles):
    rows = ["".join(".@"[blocked] for blocked in row) for row in obstacles.astype(int)]
    return "\n".join(
        ["type octile", f"height {len(rows)}", f"width {len(rows[0])}", "map", *rows, ""]
    )


@given(
    arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, max_side=12)),
    st.floats(0, 1, exclude_max=True),
)
def test_written_map_reads_back(tmp_path_factory, obstacles, free_weight):
    grid = GridMap("m", np.where(obstacles, 1.0, free_weight))
    path = save(tmp_path_factory.getbasetemp(), "m.map", write_map(obstacles))
    assert replace(READER, path=path, free_weight=free_weight).read().digest == grid.digest


def test_public_maps_and_scenarios():
    maps = sorted(DATA.glob("movingai/*/*.map"))
    if not maps:
        pytest.skip(f"no MovingAI maps in {DATA}")
    for path in maps:
        grid = replace(READER, path=str(path)).read()
        body = path.read_bytes().split(b"map", 1)[1]
        assert (~grid.obstacles).sum() == sum(body.count(c) for c in b".GS")
        scenarios = sorted(
            [
                *path.parent.glob(path.name + ".scen"),
                *path.parent.glob(path.stem + "-random-1.scen"),
            ]
        )
        assert scenarios
        for scenario in scenarios:
            problems = read_scenario(str(scenario))
            assert problems
            for problem in problems:
                assert (problem.rows, problem.cols) == grid.weights.shape
                for x, y in (problem.start, problem.target):
                    assert not grid.obstacles[y, x]
                long, short = sorted(
                    abs(a - b) for a, b in zip(problem.start, problem.target, strict=True)
                )[::-1]
                octile = long - short + short * 2**0.5
                assert problem.optimal_length >= octile - 1e-3
