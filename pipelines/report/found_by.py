"""What found the paths of a run: the first path, and what lowered its cost."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from gapath.pipelines.numbers.text import middle, percent
from gapath.pipelines.page.section import Table


def found_by(shares: Sequence[Mapping[str, float]]) -> Table:
    """Make the table of what found the paths.

    Parameters
    ----------
    shares : sequence of dict of str to float
        What a planner tells of each trial (`gapath.history.evolution.Population.shares`): name ->
        cost, the first one's that of the first path, whatever found it. At least one trial.

    Returns
    -------
    Table
        A row for the first path, one for each other name that lowered the cost, and one for the
        path that was found: medians over the trials, and in how many of them.
    """
    n = len(shares)
    began = [next(iter(each.items())) for each in shares]
    first = pd.Series([cost for _, cost in began])
    lowered = pd.DataFrame([dict(list(each.items())[1:]) for each in shares]).fillna(0.0)
    rows = {f"first path: {' or '.join(dict.fromkeys(name for name, _ in began))}": first}
    others = [name for name in lowered if lowered[name].any()]
    rows |= {f"lowered by {name}": lowered[name] for name in others}
    rows["path found"] = first - lowered.sum(axis=1)
    parts = [values / first.where(first > 0) for values in rows.values()]
    quartiles = [np.quantile(values, (0.5, 0.25, 0.75)).tolist() for values in rows.values()]
    data = pd.DataFrame(
        {
            "what": list(rows),
            **{name: [q[i] for q in quartiles] for i, name in enumerate(("cost", "q1", "q3"))},
            "part": [part.median() for part in parts],
            "trials": [n, *(int((lowered[name] > 0).sum()) for name in others), n],
        }
    )
    shown = pd.DataFrame(
        {
            "what": data["what"],
            "cost": [middle(*each) for each in quartiles],
            "% of the first path's": [percent(part) for part in data["part"].fillna(0)],
            "in trials": data["trials"].astype(str),
        }
    )
    caption = (
        f"Cost, medians (quartiles) over those trials of the log that tell it, {n}, each by "
        "itself: what the first path cost, by how much it was lowered since, what the path found "
        "costs."
    )
    return Table("found_by", caption, data, shown, heads=1, sortable=False)
