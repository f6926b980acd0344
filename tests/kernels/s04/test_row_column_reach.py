"""What S04's genotypes can express: the proof against all chromosomes that there are."""

import itertools
from functools import cache

import naive_row_column as twin
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from row_column_strategies import GENOTYPES
from strategies import problems

from gapath.grid import GridMap
from gapath.kernels.raster import polyline
from gapath.kernels.s04.genotype import Genotype
from gapath.mapio.asciigrid import Reader
from gapath.planning.flaw import flaw
from gapath.problem import CornerCutting, Problem
from gapath.survey.row_column import SquareView, classify, express

ALL = [Genotype(*genotype) for genotype in (*GENOTYPES.values(), (True, 1))]


@cache
def every_path(n, start, target):
    """Of all chromosomes on n x n fields: flag, effective switches, fields as bits of a number."""
    inner = max(n - 2, 0)
    found = []
    ends = [0] * min(n, 2)  # locations that nobody reads
    for flag, *locations in itertools.product(range(2), *[range(n)] * inner):
        for direction in itertools.product(range(2), repeat=n - 1):
            for first, second in itertools.combinations_with_replacement(range(n), 2):
                chromosome = twin.Chromosome(
                    flag, ends[:1] + locations + ends[1:], direction, [first, second]
                )
                fields = set(twin.walk(twin.corners(chromosome, start, target)))
                switches = len({first, second} - {n - 1})
                found.append((flag, switches, sum(1 << (y * n + x) for x, y in fields)))
    return np.array(found, dtype=np.int64).T


def fewest_switches(n, start, target, blocked):
    """Of any free path row-wise only, and of any at all; None where there is none."""
    flag, switches, fields = every_path(n, start, target)
    obstacles = sum(1 << (int(y) * n + int(x)) for y, x in np.argwhere(blocked))
    free = fields & obstacles == 0
    kinds = free & (flag == 0) & (switches == 0), free
    return [switches[kind].min() if kind.any() else None for kind in kinds]


def check(problem, row_wise, any_at_all):
    """Each genotype has a path exactly where it should, as its chromosome shows."""
    for genotype in ALL:
        row = express(problem, genotype)
        least = any_at_all if genotype.column_wise else row_wise
        if least is None or least > genotype.switches:
            assert row is None
        else:
            assert check_witness(problem, genotype, row) == least


def check_witness(problem, genotype, row):
    """Decode a chromosome by the twin and by gapath; give the switches that it uses."""
    chromosome, n = twin.Chromosome.of(row), max(problem.map.weights.shape)
    assert len(row) == 2 * n + 2
    assert chromosome.flag <= genotype.column_wise
    assert all(0 <= gene < n for gene in chromosome.location + chromosome.switch)
    assert all(0 <= gene < 2 for gene in [chromosome.flag, *chromosome.direction])
    weights, mirror = twin.mirrored(problem.map.weights, (problem.start, problem.target))
    points = twin.corners(chromosome, mirror(problem.start), mirror(problem.target))
    assert twin.measure(weights, twin.walk(points))[0][0] == 0
    path = polyline(SquareView.of(problem).paths(row[np.newaxis])[0])
    for rule in (problem.corner_cutting, CornerCutting.NO_DIAGONALS):
        assert flaw(Problem(problem.map, problem.start, problem.target, rule), path) is None
    used = [gene for gene in chromosome.switch if gene < n - 1]
    assert len(set(used)) == len(used)
    return len(used)


def tiny(blocked, start, target):
    return Problem(GridMap("tiny", np.where(blocked, 1.0, 0.5)), start, target)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_every_tiny_grid_has_the_paths_that_its_chromosomes_have(n):
    ends = (0, 0), (n - 1, n - 1)
    for obstacles in itertools.product([False, True], repeat=max(n * n - 2, 0)):
        blocked = np.array([False, *obstacles, False][: n * n]).reshape(n, n)
        check(tiny(blocked, *ends), *fewest_switches(n, *ends, blocked))


def test_many_grids_of_four_by_four_fields():
    seen = set()
    random = np.random.default_rng(0)
    for start, target in [((0, 0), (3, 3)), ((2, 0), (3, 1)), ((1, 1), (3, 1)), ((0, 2), (1, 3))]:
        for _ in range(500):
            blocked = random.random((4, 4)) < 0.4
            blocked[start[::-1]] = blocked[target[::-1]] = False
            expected = fewest_switches(4, start, target, blocked)
            check(tiny(blocked, start, target), *expected)
            seen.add(tuple(expected))
    assert seen == {(0, 0), (None, 0), (None, 1), (None, None)}


def test_a_grid_that_needs_two_switches():
    """The target behind a wall: only by the bottom, then up and back."""
    rows = ["##.#.", "#.#.#", "..#..", "..##.", "....."]
    blocked = np.array([[field == "#" for field in row] for row in rows])
    start, target = (1, 1), (3, 1)
    expected = fewest_switches(5, start, target, blocked)
    assert expected == [None, 2]
    check(tiny(blocked, start, target), *expected)


def test_any_number_of_switches_is_counted():
    """On five by five fields, against all chromosomes with any switches that change a path."""
    n, start, target = 5, (1, 1), (3, 1)
    ways = []
    for count in range(n - 1):
        for genes in itertools.combinations(range(n - 2), count):
            for flag, *locations in itertools.product(range(2), *[range(n)] * (n - 2)):
                for direction in itertools.product(range(2), repeat=n - 1):
                    chromosome = twin.Chromosome(flag, [0, *locations, 0], direction, genes)
                    fields = set(twin.walk(twin.corners(chromosome, start, target)))
                    ways.append((count, sum(1 << (y * n + x) for x, y in fields)))
    switches, paths = np.array(ways, dtype=np.int64).T
    random, seen = np.random.default_rng(0), set()
    for _ in range(1000):
        blocked = random.random((n, n)) < 0.45
        blocked[start[::-1]] = blocked[target[::-1]] = False
        obstacles = sum(1 << (int(y) * n + int(x)) for y, x in np.argwhere(blocked))
        free = switches[paths & obstacles == 0]
        fewest = int(free.min()) if len(free) else None
        assert classify(tiny(blocked, start, target)).switches == fewest
        seen.add(fewest)
    assert seen >= {None, 0, 1}


@settings(max_examples=200)
@given(problems(most=4, least=1))
def test_other_ends_and_maps_that_are_not_square(problem):
    weights, mirror = twin.mirrored(problem.map.weights, (problem.start, problem.target))
    rows, cols = weights.shape
    n = max(rows, cols)
    blocked = np.ones((n, n), dtype=bool)
    blocked[:rows, :cols] = weights == 1
    check(problem, *fewest_switches(n, mirror(problem.start), mirror(problem.target), blocked))


@given(problems(most=9))
def test_chromosomes_on_larger_maps(problem):
    found = [express(problem, Genotype(True, switches)) for switches in range(3)]
    for switches, row in enumerate(found):
        if row is not None:
            assert check_witness(problem, Genotype(True, switches), row) <= switches
    possible = [row is not None for row in found]
    assert possible == sorted(possible)  # a switch more never hurts


@given(problems(most=9), st.sampled_from([0, 1]))
def test_mirrored_problems_have_the_same_chromosomes(problem, axis):
    grid = problem.map
    sides = grid.cols, grid.rows
    ends = [
        tuple(sides[i] - 1 - at if i == axis else at for i, at in enumerate(place))
        for place in (problem.start, problem.target)
    ]
    other = Problem(GridMap("mirrored", np.flip(grid.weights, 1 - axis)), *ends)
    if problem.start[axis] != problem.target[axis]:
        for genotype in ALL:
            assert np.array_equal(express(problem, genotype), express(other, genotype))


# row-wise, column-wise, and the switches that are needed
CLASSES = {
    "Kamran08": (True, True, 0),
    "Kamran22": (False, False, 1),
    "Kamran36": (True, False, 0),
    "Kamran39": (False, True, 0),
    "Searchspace1": (True, False, 0),
    "Searchspace2": (True, True, 0),
    "Searchspace3": (True, True, 0),
    "Searchspace4": (False, True, 0),
    "Searchspace5": (True, True, 0),
    "corners10": (False, False, 2),
    "godugu01": (True, True, 0),
    "godugu02": (True, False, 0),
    "godugu03": (True, True, 0),
    "godugu04": (True, True, 0),
    "godugu05": (True, True, 0),
    "godugu06": (True, False, 0),
}


def test_grids_of_the_same_group_are_of_these_classes(data):
    files = sorted((data / "tulsa").glob("*.txt"))
    if not files:
        pytest.skip(f"no grids of the University of Tulsa in {data}")
    found = {}
    for file in files:
        grid = Reader(str(file), None, None, 0.5).read()
        problem = Problem(grid, grid.start, grid.target)
        transposed = Problem(GridMap("transposed", grid.weights.T), grid.start, grid.target)
        row_wise, column_wise = (
            express(posed, Genotype(False, 0)) is not None for posed in (problem, transposed)
        )
        needed = next(
            used for used in range(3) if express(problem, Genotype(True, used)) is not None
        )
        check(problem, 0 if row_wise else None, needed)
        assert (needed == 0) == (row_wise or column_wise)
        found[file.stem] = (row_wise, column_wise, needed)
    assert found == CLASSES
