"""Curves of fitness: their scale goes by what they show."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from gapath.pictures.curves import draw_convergence


@pytest.mark.parametrize(
    ("best", "scale"),
    [([59.0, 58.0, 57.5], "linear"), ([2e5, 90.0, 80.0], "log"), ([9.0, 0.0], "linear")],
)
def test_the_scale_is_logarithmic_where_numbers_are_far_apart(best, scale):
    axes = Figure().subplots()
    draw_convergence(axes, np.array(best), np.array(best) + 1)
    assert axes.get_yscale() == scale
