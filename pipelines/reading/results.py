"""What a run's trials come to."""

from gapath.errors import InputError
from gapath.store.records import TRIALS, RunRecord
from gapath.store.results import Results


def results_of(run: RunRecord) -> Results:
    """Give what a run's trials come to; of earlier versions' runs the trials are read.

    Parameters
    ----------
    run : RunRecord
        A run that can be used.

    Returns
    -------
    Results
        Its sums.

    Raises
    ------
    InputError
        If its trials cannot be read.
    """
    if run.known.results is not None:
        return run.known.results
    import pandas as pd

    from gapath.task import find_task, results  # which imports the kernels' compiler

    task = find_task(run.known.task)
    try:
        return results(task, pd.read_parquet(run.folder / TRIALS))
    except Exception as error:  # pyarrow raises more kinds than it documents
        raise InputError(TRIALS, type(error).__name__, "readable Parquet") from error
