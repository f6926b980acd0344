"""A small page for each run, and lists of runs, beside the report."""

import hashlib
import os
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import TypeAlias
from urllib.parse import quote

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.csv
from markupsafe import Markup

from gapath.errors import printable
from gapath.pipelines.numbers.text import file_size, number, percent
from gapath.pipelines.page.page import script, style, template
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.reading.logs import has_log
from gapath.pipelines.reading.tags import UNSAID, Said, said_of
from gapath.pipelines.report.found_by import found_by
from gapath.pipelines.report.stills import MOST_BYTES, MOST_RUNS, newest_logs, stills_of
from gapath.recorders.mcap import FILE
from gapath.store.durable import new_file, write_whole
from gapath.store.provenance.origin import PACKAGES, Provenance
from gapath.store.records import MANIFEST, RunRecord
from gapath.store.settings import written
from gapath.store.status import STATUS
from gapath.task import columns, find_task

FOLDER = "runs"
"""Of the report, in which the pages are."""

MOST_TRIALS = 200
"""Trials that the page of a run shows."""

ONE_OF = ", one of several problems"
"""What is said behind start and target of a run over several."""

_MOST_FILES = 30
_MARK = b'<meta name="generator" content="gapath-report">'


@dataclass
class Addresses:
    """Where rows of tables lead to, and which lists of runs there must be for that."""

    lists: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def of(self, keys: tuple[str, ...]) -> str:
        """Give the address, from the report, of the page of a run, or of a list of several."""
        if len(keys) == 1:
            return f"{FOLDER}/{_file(keys[0])}"
        name = f"of-{hashlib.sha256(' '.join(keys).encode()).hexdigest()[:16]}.html"
        self.lists[name] = keys
        return f"{FOLDER}/{name}"


def write_run_pages(
    folder: Path,
    runs: Sequence[RunRecord],
    trials: Mapping[str, pd.DataFrame],
    lists: Mapping[str, tuple[str, ...]],
) -> list[Path]:
    """Write a page for each run, the lists of runs, and the list of all.

    They are no part of a table or figure, so each is written without waiting for the disk, which
    would take ten thousand of them a minute. What an earlier report left is removed.

    Parameters
    ----------
    folder : Path
        That of the report, which is there.
    runs : sequence of RunRecord
        The runs of the report.
    trials : mapping of str to DataFrame
        Task -> their trials.
    lists : mapping of str to tuple of str
        Name of a file -> keys of the runs that it lists (`Addresses.lists`).

    Returns
    -------
    list of Path
        What was written.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    folder = folder / FOLDER
    folder.mkdir(exist_ok=True)
    rates = _rates(trials)
    written = [folder / "page.css", folder / "page.js"]
    for path, content in zip(written, (style(), script()), strict=True):
        write_whole(path, content.encode())
    said, _ = said_of(runs)
    pages = chain(_pages(folder, runs, (trials, rates, said)), _lists(runs, rates, lists, said))
    for name, text in pages:
        with new_file(folder / name) as file:
            file.write(text.encode())
        written.append(folder / name)
    for path in filter(Path.is_file, set(folder.glob("*.html")) - set(written)):
        with path.open("rb") as page:
            ours = _MARK in page.read(500)
        if ours:
            path.unlink()
    return written


def _file(key: str) -> str:
    return quote(f"{key}.html")


def _rates(trials: Mapping[str, pd.DataFrame]) -> dict[str, float]:
    """Give the success rate of each run."""
    rates: dict[str, float] = {}
    for task, frame in trials.items():
        if len(frame):
            success = frame[find_task(task).success].astype(float)
            rates |= success.groupby(frame["key"]).mean().to_dict()
    return rates


def _name(run: RunRecord) -> str:
    known = run.known
    instance = f" #{known.map_instance}" if known.map_instance else ""
    return f"{label(known.method)} on {label(known.map)}{instance}"


def _place(run: RunRecord) -> tuple[object, ...]:
    known = run.known
    method = (rank(known.map), known.map_instance, rank(known.method))
    return (known.experiment, *method, known.seed, run.folder.name)


_COLUMNS = (
    ("Run", False), ("Experiment", False), ("Map", False), ("Instance", True), ("Method", False),
    ("Seed", True), ("Trials", True), ("Succeeded, %", True), ("State", False),
    ("Finished, UTC", False), ("Tags", False),
)  # fmt: skip
"""Of a list of runs, and which hold numbers."""

_ROW = Markup(
    '<tr><th scope="row" class="head own"><a href="{}">{}</a></th><td class="text">{}</td>'
    '<td class="text">{}</td><td>{}</td><td class="text">{}</td><td>{}</td><td>{}</td>'
    '<td data-order="{}">{}</td><td class="text">{}</td><td class="text">{}</td>'
    '<td class="text">{}</td></tr>'
)


def _row(run: RunRecord, rate: float, said: Said) -> Markup:
    """Write the row of a run, which stands in several lists."""
    known = run.known
    return _ROW.format(
        _file(run.folder.name), run.folder.name[:8], known.experiment, label(known.map),
        known.map_instance, label(known.method), known.seed, known.trials, rate, percent(rate),
        run.state, run.date[:19].replace("T", " "), printable(", ".join(said.tags)),
    )  # fmt: skip


def _lists(
    runs: Sequence[RunRecord],
    rates: Mapping[str, float],
    lists: Mapping[str, tuple[str, ...]],
    said: Mapping[str, Said],
) -> Iterator[tuple[str, str]]:
    """Make the pages that list runs: some of them, and all."""
    page = template("runs.html.j2")
    runs = sorted(runs, key=_place)
    places = {run.folder.name: i for i, run in enumerate(runs)}
    rows = [_row(run, rates[run.folder.name], said.get(run.name, UNSAID)) for run in runs]
    names = [_name(run) for run in runs]
    yield "index.html", page.render(title="All runs", whole=True, rows=rows, columns=_COLUMNS)
    for name, keys in lists.items():
        mine = sorted(places[key] for key in keys)
        title = f"{number(len(mine))} runs behind a row"
        same = {names[i] for i in mine}
        title += f": {same.pop()}" if len(same) == 1 else ""
        yield name, page.render(title=title, rows=[rows[i] for i in mine], columns=_COLUMNS)


_Known: TypeAlias = tuple[Mapping[str, pd.DataFrame], Mapping[str, float], Mapping[str, Said]]
"""Trials of each task, success rate of each run, what people say of some."""


def _pages(folder: Path, runs: Sequence[RunRecord], known_of: _Known) -> Iterator[tuple[str, str]]:
    """Make the page of each run."""
    page, (trials, rates, said) = template("run.html.j2"), known_of
    rows = {key: table for task, frame in trials.items() for key, table in _rows(task, frame)}
    drawn = newest_logs(runs)
    here = folder.resolve()
    places: dict[Path, str] = {}
    methods = {task: find_task(task).groups[0] for task in trials}
    for run in runs:
        known, key = run.known, run.folder.name
        parent = run.folder.parent
        if parent not in places:
            places[parent] = os.path.relpath(parent.resolve(), here)
        place = f"{places[parent]}/{key}"
        stills, no_stills = None, _no_stills(run)
        if key in drawn:
            found = stills_of(run)
            stills, no_stills = (None, found) if isinstance(found, str) else (found, "")
        text = page.render(
            title=_name(run),
            key=key,
            experiment=known.experiment,
            what=[
                *_what(run, methods[known.task], rates[key]),
                *_said(said.get(run.name, UNSAID)),
            ],
            command=known.command,
            log=shlex.quote(str(run.folder / FILE)) if has_log(run) else "",
            files=_files(run, place),
            stills=stills,
            no_stills=no_stills,
            found_by=found_by(stills.shares) if stills and stills.shares else None,
            shown=min(known.trials, MOST_TRIALS),
            trials=known.trials,
            lines=_lines(rows[key]),
            settings=[(name, written(value)) for name, value in run.settings.items()],
            provenance=_provenance(run),
        )
        yield f"{key}.html", text


def _no_stills(run: RunRecord) -> str:
    if not has_log(run):
        return "None: the run kept no log."
    return (
        f"None: they are drawn of the newest {MOST_RUNS} runs whose logs have no more than "
        f"{file_size(MOST_BYTES)} in all."
    )


def _what(run: RunRecord, method: str, rate: float) -> list[tuple[str, str]]:
    known = run.known
    what = [
        ("state", f"{run.state}: {run.status.message}" if run.status.message else str(run.state)),
        ("task", known.task),
        ("map", f"{label(known.map)}, instance {known.map_instance}"),
        ("start, target", f"{known.start}, {known.target}" + (ONE_OF if known.queries else "")),
        (method, label(known.method)),
        ("preset", known.preset),
        *((f"changed: {name}", written(value)) for name, value in known.changes.items()),
        ("seed", str(known.seed)),
        ("trials", number(known.trials)),
        ("succeeded", f"{percent(rate)} %"),
        ("started", run.status.started),
        ("finished", run.status.finished or ""),
    ]
    return [(name, text.removesuffix("+00:00")) for name, text in what]


def _said(said: Said) -> list[tuple[str, str]]:
    tags = [(f"tag, {when[:10]}", printable(tag)) for tag, when in said.tags.items()]
    return [*tags, ("note", printable(said.note))] if said.note else tags


def _files(run: RunRecord, place: str) -> list[tuple[str, str, str]]:
    """Give name, address and size of a run's files."""
    files = list(run.known.files.items())[:_MOST_FILES]
    sizes = [(name, file_size(entry.bytes)) for name, entry in files]
    sizes += [(name, "") for name in (MANIFEST, STATUS)]
    return [(name, quote(f"{place}/{name}"), size) for name, size in sizes]


def _provenance(run: RunRecord) -> list[tuple[str, str]]:
    known = run.known
    inputs = {**known.map_inputs, **known.method_inputs, **known.late_inputs}
    return [
        ("key", known.key),
        ("setting", known.setting),
        *known.versions.items(),
        ("map's content, SHA-256", known.map_digest),
        *((f"{path}, SHA-256", digest) for path, digest in inputs.items()),
        *_origin(known.provenance or {}),
    ]


def _origin(origin: Provenance) -> Iterator[tuple[str, str]]:
    """Tell where a run comes from; of what is installed only how much."""
    for section, values in origin.items():
        if section == PACKAGES:
            yield section, f"{len(values)}, in {MANIFEST}"
            continue
        for name, value in list(values.items())[:_MOST_FILES]:
            yield f"{section}, {name}", written(value)


def _rows(task: str, trials: pd.DataFrame) -> Iterator[tuple[str, pa.Table]]:
    """Give the first trials of each run, without what is the same in all of every run."""
    if trials.empty:
        return
    keys, names = pd.factorize(trials["key"])
    if (np.diff(keys) < 0).any():
        order = np.argsort(keys, kind="stable")
        trials, keys = trials.iloc[order], keys[order]
    starts = np.searchsorted(keys, np.arange(len(names) + 1))
    first = np.arange(len(keys)) - starts[keys] < MOST_TRIALS
    if not first.all():
        trials, keys = trials[first], keys[first]
        starts = np.searchsorted(keys, np.arange(len(names) + 1))
    same_run = keys[1:] == keys[:-1]
    known = [name for name in columns(find_task(task).row) if name != "trial"]
    codes = ((name, pd.factorize(trials[name])[0]) for name in known)
    varied = [name for name, code in codes if (np.diff(code)[same_run] != 0).any()]
    table = pa.Table.from_pandas(trials[["trial", *varied]], preserve_index=False)
    for name, begin, end in zip(names, starts[:-1], starts[1:], strict=True):
        yield str(name), table.slice(begin, end - begin)


def _lines(table: pa.Table) -> str:
    """Write rows as CSV."""
    stream = pa.BufferOutputStream()
    pa.csv.write_csv(table, stream, pa.csv.WriteOptions(quoting_header="none"))
    text: str = stream.getvalue().to_pybytes().decode()
    return text
