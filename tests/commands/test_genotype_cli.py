"""The command that proves what S04's genotype can express."""

import pytest

from gapath.commands import genotype as genotype_cli

HOOK = """type octile
height 4
width 6
map
......
@@@@@.
......
..@@@@
"""


def run(capsys, *arguments):
    code = genotype_cli.main([str(argument) for argument in arguments])
    out, err = capsys.readouterr()
    rows = [line.split() for line in out.splitlines()]
    return code, rows, err


def test_the_search_spaces(capsys):
    code, (head, _, *rows), err = run(capsys, "s04_sp01", "s04_sp06", "s04_sp07")
    assert (code, err) == (0, "")
    assert head[-3:] == ["geisler", "hermanu", "sedighi"]
    assert [(row[0], row[-4:]) for row in rows] == [
        ("s04_sp01", ["0", "yes", "yes", "yes"]),
        ("s04_sp06", ["0", "no", "yes", "yes"]),
        ("s04_sp07", ["1", "no", "no", "yes"]),
    ]


def test_ends_of_ones_own_on_a_map_that_is_not_square(capsys, tmp_path):
    path = tmp_path / "hook.map"
    path.write_text(HOOK)
    code, rows, _ = run(capsys, path, "--start", "0,0", "--target", "0,3")
    assert code == 0
    # a row-wise path would have to visit the rows that the map lacks
    assert rows[2][:10] == ["hook", "6", "x", "4", "0,0", "0,3", "yes", "no", "no", "1"]


THREE = """7
0010110
1010000
1001010
1000010
0000100
1011001
0111100
"""
NEVER = """5
01000
00010
11100
00001
11000
"""


@pytest.mark.parametrize(
    ("grid", "switches"), [(THREE, ["3"]), (NEVER, ["none", "helps"])], ids=["three", "never"]
)
def test_switches_are_counted_without_a_bound(grid, switches, capsys, tmp_path):
    path = tmp_path / "grid.txt"
    path.write_text(grid)
    code, rows, _ = run(capsys, path)
    assert code == 0
    assert rows[2][6:] == ["yes", "no", "no", *switches, "no", "no", "no"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["no.txt"], "no.txt: got no such file"),
        (["s04_sp01", "--start", "0,1"], "map.start: got [0, 1], an obstacle"),
        (["s04_sp01", "--target", "0,10"], "map.target: got [0, 10]"),
        (["s04_sp09"], "map: got s04_sp09, expected one of"),
    ],
)
def test_bad_input(capsys, arguments, message):
    code, rows, err = run(capsys, *arguments)
    assert (code, rows) == (2, [])
    assert message in err


def test_bad_arguments(capsys):
    with pytest.raises(SystemExit) as end:
        genotype_cli.main(["s04_sp01", "--start", "3"])
    assert end.value.code == 2
    assert "expected two integers" in capsys.readouterr().err
