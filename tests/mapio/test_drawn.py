"""S04's search spaces: their classes are proved, not tried."""

import pytest

from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels.row_column import Genotype
from gapath.mapio.drawn import DRAWINGS, Reader
from gapath.problem import Problem
from gapath.row_column import express

# which genotypes have a path: row-wise, column-wise, and the switches that are needed
CLASSES = {
    "s04_sp01": (True, False, 0),
    "s04_sp02": (False, True, 0),
    "s04_sp03": (True, True, 0),
    "s04_sp04": (True, True, 0),
    "s04_sp05": (False, True, 0),
    "s04_sp06": (False, True, 0),
    "s04_sp07": (False, False, 1),
    "s04_sp08": (False, False, 1),
}


def expressible(problem, column_wise, switches):
    return express(problem, Genotype(column_wise, switches)) is not None


def transposed(grid):
    return Problem(GridMap("transposed", grid.weights.T), grid.start, grid.target[::-1])


def test_there_are_eight():
    assert sorted(CLASSES) == sorted(DRAWINGS)


@pytest.mark.parametrize("name", CLASSES)
def test_a_search_space_is_of_its_class(name):
    grid = Reader(name).read()
    assert grid.rows == grid.cols
    assert (grid.start, grid.target) == ((0, 0), (grid.cols - 1, grid.rows - 1))
    assert grid.source == "reconstructed"
    problem = Problem(grid, grid.start, grid.target)
    row_wise, column_wise, switches = CLASSES[name]
    assert expressible(problem, False, 0) is row_wise  # Geisler 2002
    assert expressible(transposed(grid), False, 0) is column_wise
    assert expressible(problem, True, 0) is (row_wise or column_wise)  # Hermanu 2002
    for allowed in range(3):  # S04
        assert expressible(problem, True, allowed) is (allowed >= switches)


def test_other_names_are_refused():
    with pytest.raises(InputError, match=r"map.drawing: got s04_sp09, expected one of"):
        Reader("s04_sp09")
