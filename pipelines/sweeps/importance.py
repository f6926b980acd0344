"""How much each setting matters: by how much worse a forest tells results without knowing it."""

import math
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gapath.pipelines.sweeps.varied import Factor

FEWEST = 10
"""Of fewer cells a forest learns nothing."""
_EXPLAINED = 0.05
"""A forest that explains less of the variance explains nothing."""
_MOST = 1500
"""Of more cells so many are drawn: it takes as long as all else otherwise."""
_TREES, _FOLDS, _ROUNDS = 100, 5, 10

Table = NDArray[np.float64]


class Weight(NamedTuple):
    """How much a factor matters: the share of the variance that it has a part in.

    `low` and `high` are its 95 % interval over the cells.
    """

    name: str
    share: float
    low: float
    high: float

    @property
    def told(self) -> bool:
        """Whether it is more than none."""
        return self.low > 0


class Importance(NamedTuple):
    """What a forest knows of a sweep."""

    weights: tuple[Weight, ...]
    """The largest first; empty where it cannot be told."""
    explained: float
    """R² of the forest's predictions of cells that each of its trees did not see; NaN without."""
    why: str
    """Why it cannot be told, empty where it can."""


def importance(cells: pd.DataFrame, factors: tuple[Factor, ...], result: Table) -> Importance:
    """Tell how much each factor matters by permutation in a random forest (Breiman 2001).

    The forest is grown on four fifths of the cells and asked about the others, five times; a
    factor's values are then drawn from other cells. Half of what the squared error grows by is the
    variance that the factor has a part in, alone or with others: its total effect (Jansen 1999).
    The same cells give the same importance.

    Parameters
    ----------
    cells : DataFrame
        One row a cell, a column for each factor.
    factors : tuple of Factor
        What varied.
    result : (n,) float64
        What each cell came to; NaN or infinite ones are left out.

    Returns
    -------
    Importance
        How much each matters, or why that cannot be told.
    """
    from sklearn.ensemble import RandomForestRegressor

    known = np.isfinite(result)
    features, owner = _features(cells[known], factors)
    y = result[known]
    if len(y) < FEWEST:
        return Importance((), math.nan, f"{len(y)} cells, of fewer than {FEWEST} nothing is learnt")
    if y.min() == y.max():
        return Importance((), math.nan, "all cells came to the same")
    random = np.random.Generator(np.random.SFC64(0))
    if len(y) > _MOST:
        drawn = np.sort(random.choice(len(y), _MOST, replace=False))
        features, y = features[drawn], y[drawn]
    forest = RandomForestRegressor(_TREES, oob_score=True, random_state=0)
    explained = float(forest.fit(features, y).oob_score_)
    if explained < _EXPLAINED:
        return Importance((), explained, "the forest explains nothing of cells it did not see")
    errors = _errors(features, y, owner, random)
    worse = (errors[1:] - errors[0]) / (2 * y.var())
    share = worse.mean(axis=1)
    half = 1.96 * worse.std(axis=1, ddof=1) / math.sqrt(len(y))
    weights = [
        Weight(factor.name, *map(float, (share[i], share[i] - half[i], share[i] + half[i])))
        for i, factor in enumerate(factors)
    ]
    return Importance(tuple(sorted(weights, key=lambda each: -each.share)), explained, "")


def _features(cells: pd.DataFrame, factors: tuple[Factor, ...]) -> tuple[Table, NDArray[np.int64]]:
    """Give numbers as they are, of others a column a value, and each column's factor."""
    columns, owner = [], []
    for i, factor in enumerate(factors):
        values = cells[factor.name]
        if factor.numeric:
            columns.append(values.astype(float).to_numpy())
            owner.append(i)
            continue
        texts = values.map(repr).to_numpy()
        columns += [(texts == repr(level)).astype(float) for level in factor.levels]
        owner += [i] * len(factor.levels)
    return np.stack(columns, axis=1), np.array(owner)


def _errors(
    features: Table, y: Table, owner: NDArray[np.int64], random: np.random.Generator
) -> Table:
    """Give the squared error of each cell when it was held out: as it is, and each factor drawn.

    Drawn are the factor's values of other cells, a few times; the mean counts.
    """
    from sklearn.ensemble import RandomForestRegressor

    n, count = len(y), int(owner.max()) + 1
    errors = np.zeros((count + 1, n))
    fold = random.permutation(n) % _FOLDS
    for part in range(_FOLDS):
        out = fold == part
        forest = RandomForestRegressor(_TREES, random_state=part)
        forest.fit(features[~out], y[~out])
        mine = features[out]
        asked = [mine]
        for i in range(count):
            for _ in range(_ROUNDS):
                drawn = mine.copy()
                others = features[random.integers(n, size=len(mine))]
                drawn[:, owner == i] = others[:, owner == i]
                asked.append(drawn)
        told = forest.predict(np.concatenate(asked)).reshape(len(asked), -1)
        missed = (told - y[out]) ** 2
        errors[0, out] = missed[0]
        errors[1:, out] = missed[1:].reshape(count, _ROUNDS, -1).mean(axis=1)
    return errors
