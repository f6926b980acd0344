"""What a run's trials come to."""

from gapath.errors import InputError
from gapath.pipelines.reading.bounded import check_size, check_sums
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
        If its trials cannot be read, or come to what no trials can.
    """
    if run.known.results is not None:
        check_sums(run.known.results)
        return run.known.results
    from pyarrow import parquet

    from gapath.task import columns, find_task, results  # which imports the kernels' compiler

    task = find_task(run.known.task)
    try:
        file = parquet.ParquetFile(run.folder / TRIALS)
        check_size(file.metadata, file.schema_arrow.names, run.known.trials)
        there = set(file.schema_arrow.names)
        numbers = [name for name, kind in columns(task.row).items() if kind is not str]
        rows = file.read([name for name in numbers if name in there], use_threads=False)
        return results(task, {name: rows[name].to_numpy() for name in rows.column_names})
    except InputError:
        raise
    except Exception as error:  # pyarrow raises more kinds than it documents
        raise InputError(TRIALS, type(error).__name__, "readable Parquet") from error
