"""The report: every table and figure as files, and all of them on one page."""

import gc
import os
import platform
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

import pandas as pd
from tqdm import tqdm

from gapath.errors import InputError, require
from gapath.pipelines.page.page import Part, files_of, render
from gapath.pipelines.page.section import ALL, find_sections
from gapath.pipelines.reading.collect import Skipped, read_trials
from gapath.pipelines.reading.counted import incomplete
from gapath.pipelines.reading.tags import said_of
from gapath.pipelines.report.bench import make_bench_page
from gapath.pipelines.report.command import as_sweeps
from gapath.pipelines.report.run_pages import Addresses, write_run_pages
from gapath.running.sweep import unfinished
from gapath.store.durable import write_whole
from gapath.store.provenance.machine import processor
from gapath.store.records import RunRecord, find_runs

_PAPERS = {"kg18": "KG18", "s04": "S04", "m22": "M22", "field": "Many problems"}
"""Rooms of `pipelines`, and what the menu calls them."""

_OTHERS = "Own experiments"


def make_report(outputs: Path, folder: Path) -> tuple[list[Path], list[Skipped]]:
    """Write tables, figures and the pages from all runs and benchmarks below a folder.

    Parameters
    ----------
    outputs : Path
        The folder that holds ``<experiment>/<key>/`` and ``bench/``.
    folder : Path
        Where to write; made if it does not exist.

    Returns
    -------
    files : list of Path
        What was written, pages of runs included, the page ``index.html`` last; ``bench.html``
        where there are no runs.
    skipped : list of Skipped
        The runs that were left out, and why.

    Raises
    ------
    InputError
        If there is no such folder, or neither a run nor benchmarks in it that can be used.
    """
    try:
        return _make(outputs, folder)
    finally:
        gc.unfreeze()


def _make(outputs: Path, folder: Path) -> tuple[list[Path], list[Skipped]]:
    files, skipped = make_bench_page(outputs / "bench")
    beside: Callable[[Path], list[Path]] | None = None
    try:
        more, beside, skipped = _runs_page(outputs, bool(files), skipped)
        files += more
    except InputError as error:
        if not files:
            raise
        skipped.append(Skipped("runs", str(error)))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        written = beside(folder) if beside else []
        for name, content in files:
            write_whole(folder / name, content)
    except OSError as error:
        raise InputError(folder, error.strerror, "a folder that can be written") from error
    return [*written, *(folder / name for name, _ in files)], skipped


def _runs_page(
    outputs: Path, bench: bool, skipped: list[Skipped]
) -> tuple[list[tuple[str, bytes]], Callable[[Path], list[Path]], list[Skipped]]:
    """Make the page of the runs, with a link to the benchmarks' and what was left out of that.

    What writes the pages of single runs beside it is given, too.
    """
    runs = find_runs(outputs)
    gc.freeze()  # else the collector walks through all of them again and again
    trials, unusable, used = read_trials(runs)
    gc.freeze()
    count = sum(map(len, trials.values()))
    first = f"; {unusable[0].run}: {unusable[0].reason}" if unusable else ""
    require(count > 0, outputs, f"{len(runs)} runs of which none can be used"
            f"{first}", "a finished run")  # fmt: skip
    skipped += [Skipped(str(each.path.relative_to(outputs)), each.unfinished())
                for each in unfinished(outputs)]  # fmt: skip
    skipped += [Skipped(*each) for each in incomplete(used)]
    skipped = skipped + unusable + [Skipped(each.where, str(each)) for each in said_of(runs)[1]]
    frames = list(trials.values())
    parts = []
    modules = find_sections()
    for module in tqdm(modules, "sections", disable=None):
        for task in [task for task in trials if module.TASK in (ALL, task)]:
            for place, mine in _wanted(module, modules, task, trials[task]):
                more = _parts(module, place, mine, used)
                parts += more
                skipped += [Skipped(*entry) for part in more for entry in part.section.skipped]
    parts.sort(key=lambda part: [*_PAPERS.values(), _OTHERS].index(part.group))
    skipped = list(dict.fromkeys(skipped))  # two figures may read the same log
    addresses = Addresses()
    page = render(
        "report.html.j2",
        page_of=addresses.of,
        parts=parts,
        bench=bench,
        trials=count,
        runs=used,
        reconstructed=any((frame["map_source"] == "reconstructed").any() for frame in frames),
        skipped=skipped,
        versions=_versions(used),
        machine=_machine(),
        made=max(run.date for run in used)[:16].replace("T", " "),
    )
    files = [file for part in parts for file in files_of(part.section)]
    beside = partial(write_run_pages, runs=used, trials=trials, lists=addresses.lists)
    return [*files, ("index.html", page.encode())], beside, skipped


def _wanted(
    module: ModuleType, modules: Sequence[ModuleType], task: str, trials: pd.DataFrame
) -> Iterator[tuple[str, pd.DataFrame]]:
    """Give the trials of a task that a section wants, each time it is asked, and its anchor."""
    anchor = _anchor(module, task)
    if module.EXPERIMENT == ALL:
        yield anchor, trials
    elif module.EXPERIMENT is None:
        wanted = {other.EXPERIMENT for other in modules if other.TASK in (ALL, task)}
        for name in sorted(set(trials["experiment"].unique()) - wanted):
            yield f"{anchor}-{name}", _where(trials, name)
    else:
        yield anchor, _where(trials, module.EXPERIMENT)


def _where(trials: pd.DataFrame, experiment: str) -> pd.DataFrame:
    """Give an experiment's trials; where these are all, no second copy of a million rows."""
    mine = trials["experiment"] == experiment
    return trials if mine.all() else trials[mine]


def _runs_of(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> list[RunRecord]:
    """Give the runs that trials come from."""
    used = set(trials["key"].unique())
    return [run for run in runs if run.folder.name in used]


def _parts(
    module: ModuleType, anchor: str, trials: pd.DataFrame, runs: Sequence[RunRecord]
) -> list[Part]:
    """Ask a module for its sections; none where it has nothing to show."""
    runs = _runs_of(trials, runs)
    made = (module.section(trials, runs) if len(trials) else None) or []
    parts = []
    for i, section in enumerate(made if isinstance(made, list) else [made]):
        about = set(section.runs)
        mine = [run for run in runs if not about or run.folder.name in about]
        commands = as_sweeps(run.known.command for run in mine)
        place = f"{anchor}-{i + 1}" if i else anchor
        parts.append(Part(place, section, commands, _group(module)))
    return parts


def _anchor(module: ModuleType, task: str) -> str:
    """Name a section's place on the page: no two modules have the same path."""
    path = module.__name__.removeprefix("gapath.pipelines.")
    words = path.replace("_", ".").split(".")
    return "-".join([*words, task] if module.TASK == ALL else words)


def _group(module: ModuleType) -> str:
    """Tell under which heading the menu has a section: its paper's, or that of all others."""
    room = module.__name__.removeprefix("gapath.pipelines.").partition(".")[0]
    return _PAPERS.get(room, _OTHERS)


def _versions(runs: Sequence[RunRecord]) -> list[tuple[str, str]]:
    """Give each program with its version in the runs; several where the runs differ."""
    names = sorted({name for run in runs for name in run.known.versions})
    return [
        (name, ", ".join(sorted({str(run.known.versions.get(name, "?")) for run in runs})))
        for name in names
    ]


def _machine() -> list[tuple[str, str]]:
    return [
        ("processor", processor()),
        ("cores", str(os.cpu_count())),
        ("system", f"{platform.system()} {platform.machine()}"),
        ("Python", platform.python_version()),
        ("gapath", version("gapath")),
    ]
