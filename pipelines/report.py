"""The report: every table and figure as files, and all of them on one page."""

import base64
import os
import platform
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

import pandas as pd
from jinja2 import Environment, FileSystemLoader
from tqdm import tqdm

from gapath.durable import write_whole
from gapath.errors import InputError, require

from .collect import Skipped, read_trials
from .command import as_sweeps
from .runs import Run, find_runs
from .section import Section, find_sections

_HERE = Path(__file__).parent


@dataclass(frozen=True)
class Part:
    """A section as the page shows it: with the commands that made its trials.

    Parameters
    ----------
    anchor : str
        The name of the section's place on the page.
    section : Section
        Its content.
    commands : list of str
        What to type to make its runs.
    """

    anchor: str
    section: Section
    commands: list[str]


def make_report(outputs: Path, folder: Path) -> tuple[list[Path], list[Skipped]]:
    """Write tables, figures and the page from all runs below a folder.

    Parameters
    ----------
    outputs : Path
        The folder that holds ``<experiment>/<key>/``.
    folder : Path
        Where to write; made if it does not exist.

    Returns
    -------
    files : list of Path
        What was written, the page ``index.html`` last.
    skipped : list of Skipped
        The runs that were left out, and why.

    Raises
    ------
    InputError
        If there is no such folder, or no run in it that can be used.
    """
    runs = find_runs(outputs)
    plans, drives, skipped = read_trials(runs)
    first = f"; {skipped[0].run}: {skipped[0].reason}" if skipped else ""
    require(len(plans) + len(drives) > 0, outputs, f"{len(runs)} runs of which none can be used"
            f"{first}", "a finished run")  # fmt: skip
    runs = _runs_of([plans, drives], runs)
    parts = []
    modules = find_sections()
    for module in tqdm(modules, "sections", disable=None):
        trials = {"plan": plans, "drive": drives}[module.TASK]
        if module.EXPERIMENT is None:
            wanted = {other.EXPERIMENT for other in modules if other.TASK == module.TASK}
            mine = trials[~trials["experiment"].isin(wanted)]
        else:
            mine = trials[trials["experiment"] == module.EXPERIMENT]
        part = _part(module, mine, runs)
        if part is not None:
            parts.append(part)
            skipped += [Skipped(*entry) for entry in part.section.skipped]
    skipped = list(dict.fromkeys(skipped))  # two figures may read the same log
    page = render_page(parts, [plans, drives], runs, skipped)
    files = [file for part in parts for file in _files(part.section)]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in [*files, ("index.html", page.encode())]:
            write_whole(folder / name, content)
    except OSError as error:
        raise InputError(folder, error.strerror, "a folder that can be written") from error
    return [folder / name for name, _ in files] + [folder / "index.html"], skipped


def render_page(
    parts: Sequence[Part],
    trials: Sequence[pd.DataFrame],
    runs: Sequence[Run],
    skipped: Sequence[Skipped],
) -> str:
    """Render the page: one file that asks nothing of a network.

    Parameters
    ----------
    parts : sequence of Part
        The sections in their order.
    trials : sequence of DataFrame
        All trials, a frame a task.
    runs : sequence of Run
        The runs they come from.
    skipped : sequence of Skipped
        The runs that were left out, and why.

    Returns
    -------
    str
        HTML.
    """
    environment = Environment(
        loader=FileSystemLoader(_HERE),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["base64"] = lambda data: base64.b64encode(data).decode()
    return environment.get_template("report.html.j2").render(
        css=(_HERE / "report.css").read_text(encoding="utf-8"),
        parts=parts,
        trials=sum(map(len, trials)),
        runs=runs,
        reconstructed=any((frame["map_source"] == "reconstructed").any() for frame in trials),
        skipped=skipped,
        versions=_versions(runs),
        machine=_machine(),
        made=max(run.date for run in runs)[:16].replace("T", " "),
    )


def _runs_of(trials: Iterable[pd.DataFrame], runs: Sequence[Run]) -> list[Run]:
    """Give the runs that the trials come from."""
    used = {key for frame in trials for key in frame["key"]}
    return [run for run in runs if run.folder.name in used]


def _part(module: ModuleType, trials: pd.DataFrame, runs: Sequence[Run]) -> Part | None:
    """Ask a module for its section; None where it has nothing to show."""
    runs = _runs_of([trials], runs)
    section = module.section(trials, runs) if len(trials) else None
    if section is None:
        return None
    commands = as_sweeps(run.manifest["command"] for run in runs)
    return Part(module.__name__.rpartition(".")[2], section, commands)


def _files(section: Section) -> Iterator[tuple[str, bytes]]:
    """Give the name and content of each file of a section."""
    for table in section.tables:
        yield f"{table.name}.csv", table.csv().encode()
        yield f"{table.name}.md", table.markdown().encode()
        yield f"{table.name}.tex", table.latex().encode()
    for figure in section.figures:
        yield f"{figure.name}.svg", figure.svg
        yield f"{figure.name}.png", figure.png


def _versions(runs: Sequence[Run]) -> list[tuple[str, str]]:
    """Give each program with its version in the runs; several where the runs differ."""
    names = sorted({name for run in runs for name in run.manifest["versions"]})
    return [
        (name, ", ".join(sorted({str(run.manifest["versions"].get(name, "?")) for run in runs})))
        for name in names
    ]


def _machine() -> list[tuple[str, str]]:
    model = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        for line in cpuinfo.read_text(encoding="utf-8", errors="replace").splitlines():
            if line.startswith("model name"):
                model = line.partition(":")[2].strip()
                break
    return [
        ("processor", model),
        ("cores", str(os.cpu_count())),
        ("system", f"{platform.system()} {platform.machine()}"),
        ("Python", platform.python_version()),
        ("gapath", version("gapath")),
    ]
