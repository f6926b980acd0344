"""What of ``gapath-log`` is about crates: runs handed over, and done again."""

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gapath.errors import printable, require
from gapath.recorders import mcap
from gapath.recorders.mcap import FILE
from gapath.store.records import RunRecord, find_run, is_run, read_record

if TYPE_CHECKING:
    from gapath.crates.description import Packed

_CODES = {"reproduced": 0, "equivalent": 0, "different": 1, "inconclusive": 3}


def add(commands: Any) -> None:
    """Add the commands ``crate`` and ``repeat``.

    Parameters
    ----------
    commands : argparse subparsers
        Those of ``gapath-log``.
    """
    text = "hand over a run, or all whole runs of an experiment, as a Process Run Crate"
    crate = commands.add_parser("crate", help=text, description=f"{text[0].upper()}{text[1:]}.")
    about = "the folder of a run or an experiment, or its name in --outputs: the beginning of a key"
    crate.add_argument("given", metavar="KEY|EXPERIMENT", help=about)
    crate.add_argument("target", type=Path, metavar="DIR", help="the folder that it becomes")
    add_outputs(crate)
    crate.add_argument("--author", default="", metavar="NAME", help="who did the runs")
    about = "the author's organization and its address"
    crate.add_argument("--organization", nargs=2, metavar=("NAME", "URL"), help=about)
    about = "address of the licence (default: none is given)"
    crate.add_argument("--licence", default="", metavar="URL", help=about)
    crate.set_defaults(run=_crate)
    text = (
        "do all runs of a crate again and compare; exit code 1 if one differs, 3 if one cannot tell"
    )
    repeat = commands.add_parser("repeat", help=text, description=f"{text[0].upper()}{text[1:]}.")
    repeat.add_argument("crate", type=Path, metavar="CRATE", help="its folder")
    repeat.add_argument("--json", action="store_true", help="answer as JSON")
    repeat.add_argument("--yes", action="store_true", help="also if it takes long")
    repeat.add_argument("--large", action="store_true", help="also logs that are unusually large")
    repeat.set_defaults(run=_repeat)


def add_outputs(command: argparse.ArgumentParser) -> None:
    """Add the option that says where runs are looked for which are named by their keys."""
    where = "where names are looked for (default: outputs)"
    command.add_argument("--outputs", type=Path, default=Path("outputs"), metavar="DIR", help=where)


def _crate(arguments: argparse.Namespace) -> int:
    from gapath.crates.description import Credits
    from gapath.crates.packing import pack

    organization = tuple(arguments.organization) if arguments.organization else None
    for name, url in (("licence", arguments.licence), ("organization", (organization or [""])[-1])):
        good = not url or url.startswith(("http://", "https://"))
        require(good, f"--{name}", url, "an address, http or https")
    runs = _runs(arguments.given, arguments.outputs)
    for run in runs:
        if run.fault:
            _tell(f"left out {run.name}: {run.fault}")
    whole = [run for run in runs if not run.fault]
    reason = runs[0].fault if len(runs) == 1 else "no whole run"
    require(bool(whole), arguments.given, reason, "a run that is whole; the same command does it")
    credit = Credits(arguments.author, organization, arguments.licence)
    packed = pack(whole, arguments.target, credit)
    files = {
        place: entry for each in packed for place, entry in {**each.files, **each.inputs}.items()
    }
    size = sum(entry.bytes for entry in files.values())
    print(printable(f"{arguments.target}: {_count(packed)}, {len(files)} files, {size} bytes"))
    for told in dict.fromkeys(note for each in packed for note in _notes(each)):
        print(printable(f"  {told}"))
    return 0


def _count(runs: Sequence[object]) -> str:
    return f"{len(runs)} run{'s' * (len(runs) > 1)}"


def _notes(packed: "Packed") -> Iterator[str]:
    """Say what of a run lies in the crate besides, what is missing, and what it gives away."""
    for place in packed.inputs:
        yield f"with {place}"
    for name in packed.missing:
        yield f"without {name}, which is gone or has changed; its map is in the log"
    for name, value in packed.run.settings.items():
        if isinstance(value, str) and Path(value).is_absolute():
            yield f"the runs' own files say {name}: {value}, as it was typed"
    if FILE not in packed.run.known.files:
        yield f"{packed.run.name} has no log, so nobody can repeat it: do it with recorder=mcap"


def _runs(given: str, outputs: Path) -> list[RunRecord]:
    """Find the run, or those of the experiment, that somebody named."""
    folder = outputs / given if "/" not in given else Path(given)
    folder = folder if given and folder.is_dir() and not is_run(folder) else Path(given)
    if not given or not folder.is_dir() or is_run(folder):
        folder = find_run(outputs, given)
    folder = folder.resolve()
    if is_run(folder):
        return [read_record(folder)]
    found = [each for each in sorted(folder.iterdir()) if each.is_dir() and is_run(each)]
    require(bool(found), given, "no run", "the folder of a run, or of an experiment that has some")
    return [read_record(each) for each in found]


def _repeat(arguments: argparse.Namespace) -> int:
    from gapath.crates.repeating import Verdict, repeat, worst

    limits = mcap.LARGE if arguments.large else mcap.USUAL
    done = []
    for run in repeat(arguments.crate, limits, arguments.yes):
        done.append(run)
        if not arguments.json:
            print(printable(f"{run.run}: {run.verdict}, {run.told}"), flush=True)
    verdict = worst([run.verdict for run in done])
    if arguments.json:
        answer = {"verdict": verdict, "runs": [run._asdict() for run in done]}
        print(json.dumps(answer, indent=2))
    else:
        counts = {each: sum(run.verdict is each for run in done) for each in Verdict}
        each = ", ".join(f"{count} {name}" for name, count in counts.items() if count)
        print(printable(f"{arguments.crate}: {verdict}; of {_count(done)} {each}"))
    return _CODES[verdict]


def _tell(line: str) -> None:
    print(printable(f"gapath-log: {line}"), file=sys.stderr)
