"""S04's search spaces: their classes are proved, not tried."""

import pytest

from gapath.errors import InputError
from gapath.kernels.s04.genotype import Genotype
from gapath.mapio.drawn import SEARCH_SPACES, Reader
from gapath.problem import Problem
from gapath.survey.row_column import Class, classify, express

CLASSES = {
    "s04_sp01": Class(True, False, 0),
    "s04_sp02": Class(False, True, 0),
    "s04_sp03": Class(True, True, 0),
    "s04_sp04": Class(True, True, 0),
    "s04_sp05": Class(False, True, 0),
    "s04_sp06": Class(False, True, 0),
    "s04_sp07": Class(False, False, 1),
    "s04_sp08": Class(False, False, 1),
}


def test_there_are_eight():
    assert sorted(CLASSES) == sorted(SEARCH_SPACES)


@pytest.mark.parametrize("name", CLASSES)
def test_a_search_space_is_of_its_class(name):
    grid = Reader(name).read()
    assert grid.rows == grid.cols
    assert (grid.start, grid.target) == ((0, 0), (grid.cols - 1, grid.rows - 1))
    assert grid.source == "reconstructed"
    problem = Problem(grid, grid.start, grid.target)
    assert classify(problem) == CLASSES[name]
    row_wise, column_wise, switches = CLASSES[name]
    for genotype, possible in (
        (Genotype(False, 0), row_wise),  # Geisler 2002
        (Genotype(True, 0), row_wise or column_wise),  # Hermanu 2002
        (Genotype(True, 1), switches <= 1),
        (Genotype(True, 2), switches <= 2),  # S04
    ):
        assert (express(problem, genotype) is not None) is possible


def test_other_names_are_refused():
    with pytest.raises(InputError, match=r"map.drawing: got s04_sp09, expected one of"):
        Reader("s04_sp09")
