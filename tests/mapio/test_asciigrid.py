import pytest

from gapath.errors import InputError
from gapath.mapio.asciigrid import Reader

GRID = "3\n010\n000\n110\n"


def save(folder, content):
    path = folder / "grid.txt"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return str(path)


def read(path, start=None, target=None, free_weight=0.5):
    return Reader(path, start, target, free_weight).read()


def test_a_grid_goes_from_corner_to_corner(tmp_path):
    grid = read(save(tmp_path, GRID))
    assert grid.weights.tolist() == [[0.5, 1.0, 0.5], [0.5] * 3, [1.0, 1.0, 0.5]]
    assert (grid.name, grid.source, grid.start, grid.target) == (
        "grid",
        "asciigrid",
        (0, 0),
        (2, 2),
    )


def test_settings_replace_ends_and_weight(tmp_path):
    grid = read(save(tmp_path, GRID), [2, 0], [0, 1], 0.25)
    assert (grid.start, grid.target) == ((2, 0), (0, 1))
    assert grid.weights[1].tolist() == [0.25] * 3


@pytest.mark.parametrize(
    "text",
    [
        GRID.rstrip("\n"),
        GRID + "\n \n\n",
        GRID.replace("\n", "\r\n"),
        "\ufeff" + GRID,
        GRID.replace("\n", " \n"),
        GRID.replace("3\n", "03\n"),
    ],
)
def test_line_ends_mark_and_blanks_do_not_matter(tmp_path, text):
    assert read(save(tmp_path, text)).digest == read(save(tmp_path, GRID)).digest


def test_one_field_is_a_grid(tmp_path):
    grid = read(save(tmp_path, "1\n0"))
    assert (grid.weights.tolist(), grid.start, grid.target) == ([[0.5]], (0, 0), (0, 0))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", ": got 0 bytes, expected between 1 and "),
        (b"3\n0\xff0\n", ": got byte 0xff at position 3, expected text in UTF-8"),
        (b"\n", ", line 1: got '', expected the number of rows"),
        ("three\n", ", line 1: got 'three', expected the number of rows"),
        ("-3\n", ", line 1: got '-3', expected the number of rows"),
        ("3.0\n", ", line 1: got '3.0', expected the number of rows"),
        ("3 3\n", ", line 1: got '3 3', expected the number of rows"),
        ("\u0663\n", ", line 1: got '\u0663', expected the number of rows"),
        ("010\n000\n110\n", ": got 2 rows, expected 10, as line 1 says"),
        ("1" * 5000, ", line 1: got '" + "1" * 40 + "', expected the number of rows"),
        ("0\n", ", line 1: got 0, expected from 1 to 8192 rows"),
        ("8193\n", ", line 1: got 8193, expected from 1 to 8192 rows"),
        ("3\n", ": got 0 rows, expected 3, as line 1 says"),
        (GRID + "000\n", ": got 4 rows, expected 3, as line 1 says"),
        (GRID.replace("000\n", "\n"), ", line 3: got 0 characters, expected 3: the grid is square"),
        (GRID.replace("000", "0000"), ", line 3: got 4 characters, expected 3: the grid is square"),
        (
            GRID.replace("010", " 10"),
            ", line 2: got ' 10', expected 0 (free) and 1 (obstacle) only",
        ),
        (
            GRID.replace("110", "1x0"),
            ", line 4: got '1x0', expected 0 (free) and 1 (obstacle) only",
        ),
        (GRID.replace("110", "1\u06600"), ", line 4: got '1\u06600', expected 0 (free) and 1 "),
    ],
)
def test_bad_grid(tmp_path, content, message):
    path = save(tmp_path, content)
    with pytest.raises(InputError) as caught:
        read(path)
    assert str(caught.value).startswith(path + message)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"start": [1]}, "map.start: got [1], expected two integers [x, y]"),
        ({"target": [1, 2, 3]}, "map.target: got [1, 2, 3], expected two integers [x, y]"),
        ({"free_weight": 1.0}, "map.free_weight: got 1.0, expected a number in [0, 1)"),
        ({"free_weight": -0.1}, "map.free_weight: got -0.1, expected a number in [0, 1)"),
        ({"free_weight": float("nan")}, "map.free_weight: got nan, expected a number in [0, 1)"),
    ],
)
def test_bad_settings(tmp_path, settings, message):
    with pytest.raises(InputError) as caught:
        read(save(tmp_path, GRID), **settings)
    assert str(caught.value) == message


def test_a_missing_file_is_named(tmp_path):
    path = str(tmp_path / "none.txt")
    with pytest.raises(InputError) as caught:
        read(path)
    assert str(caught.value) == f"{path}: got no such file, expected an existing file"


def test_public_grids(data):
    files = sorted((data / "tulsa").glob("*.txt"))
    if not files:
        pytest.skip(f"no grids of the University of Tulsa in {data}")
    for file in files:
        grid = read(str(file))
        head, *rows = file.read_text().split()
        assert grid.weights.shape == (int(head), int(head))
        assert grid.obstacles.sum() == sum(row.count("1") for row in rows)
        assert (grid.start, grid.target) == ((0, 0), (int(head) - 1, int(head) - 1))
