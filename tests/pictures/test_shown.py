"""What a notebook shows of an object."""

import subprocess
import sys

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.figure import Figure

import gapath
from gapath.errors import InputError
from gapath.pictures.shown import Shown, axes_for


class Thing(Shown):
    def __init__(self, drawable):
        self.drawable = drawable

    def plot(self, ax=None):
        if not self.drawable:
            raise InputError("thing", "nothing", "something to draw")
        return ax

    def _told(self):
        return {"what": "a <thing>"}


@pytest.mark.parametrize("drawable", [True, False])
def test_a_table_stands_beside_a_picture_where_there_is_one(drawable):
    html = Thing(drawable)._repr_html_()
    assert ("data:image/png;base64," in html) is drawable
    assert "<caption>gapath.Thing</caption>" in html
    assert "a &lt;thing&gt;" in html


def test_what_is_shown_leaves_no_figure_open():
    before = pyplot.get_fignums()
    gapath.GridMap("mine", np.full((3, 4), 0.5))._repr_html_()
    assert pyplot.get_fignums() == before


def test_dollars_in_a_name_are_no_formula():
    weights = np.zeros((5, 5))
    free = gapath.GridMap("a$b_$x", weights, (0, 0), (4, 4))
    walled = gapath.GridMap("a$b_$x", np.where(np.arange(5) == 2, 1.0, weights), (0, 0), (4, 4))
    drive = gapath.drive(free, navigator="replan_astar")
    plans = [gapath.plan(grid, planner="astar") for grid in (free, walled)]
    for shown in (free, *plans, drive):
        assert "data:image/png;base64," in shown._repr_html_()
        axes = shown.plot(Figure().subplots())
        assert axes.get_title().startswith("a$b_$x") and not axes.title.get_parse_math()


def test_a_plot_has_a_figure_of_its_own_or_the_axes_that_it_is_given():
    axes = axes_for(None)
    assert axes.figure.number in pyplot.get_fignums()
    pyplot.close(axes.figure)
    mine = Figure().subplots()
    assert axes_for(mine) is mine


def test_nothing_is_imported_to_draw_before_something_is_drawn():
    code = (
        "import sys, gapath\n"
        "grid = gapath.load_map('kg18_test1')\n"
        "gapath.plan(grid, planner='astar'), gapath.drive, gapath.Drive\n"
        "print(*{'matplotlib', 'pandas', 'PIL'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""
