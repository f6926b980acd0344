"""Many problems on maps of one's own: what `experiment=field` has, of every other experiment."""

from collections.abc import Sequence

import pandas as pd

from gapath.pipelines.field import figure_lengths, table_lengths, table_maps
from gapath.pipelines.page.section import Section
from gapath.store.records import RunRecord

TASK = "scenario"
EXPERIMENT = None
ORDER = 99.5


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> list[Section]:
    """Make the sections of an experiment.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    list of Section
        By length, as a figure, and map by map; none if no problem has a way.
    """
    made = [module.section(trials, runs) for module in (table_lengths, figure_lengths, table_maps)]
    return [each for each in made if each]
