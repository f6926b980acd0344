"""Which runs a row of a table is made from."""

from collections.abc import Sequence

import pandas as pd


def keys_behind(
    trials: pd.DataFrame, by: Sequence[str], rows: pd.DataFrame
) -> tuple[tuple[str, ...], ...]:
    """Give for each row of a table the keys of its runs, as `page.section.Table.runs` has them.

    Parameters
    ----------
    trials : DataFrame
        One row a trial, with the columns `by` and `key`. What stands in `by` is one value a run.
    by : sequence of str
        The columns that name a row.
    rows : DataFrame
        The table's rows, with the columns `by`.

    Returns
    -------
    tuple of tuple of str
        Keys, sorted; none for a row of which there is no trial.
    """
    runs = trials.drop_duplicates("key")[[*by, "key"]].astype(object)
    keys: dict[tuple[object, ...], list[str]] = {}
    for *name, key in runs.itertuples(index=False):
        keys.setdefault(tuple(name), []).append(key)
    wanted = rows[list(by)].astype(object).itertuples(index=False)
    return tuple(tuple(sorted(keys.get(tuple(name), ()))) for name in wanted)
