"""The commands `gapath-report tag`, `note`, `prune` and `archive`."""

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from gapath.errors import printable, require
from gapath.pipelines.keeping.archive import pack
from gapath.pipelines.keeping.prune import Why, choose, remove, size_of
from gapath.pipelines.numbers.text import file_size
from gapath.pipelines.reading.tags import Said, say
from gapath.store.records import find_run, find_runs
from gapath.store.status import now


def main(arguments: Sequence[str]) -> None:
    """Do what the first argument says; raises InputError for what cannot be done."""
    name, *rest = arguments
    _COMMANDS[name](rest)


def _parser(name: str, about: str) -> argparse.ArgumentParser:
    return argparse.ArgumentParser(f"gapath-report {name}", description=about)


def _outputs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--outputs", type=Path, default=Path("outputs"), metavar="DIR", help=_WHERE)


_WHERE = "folder with <experiment>/<key>/ [outputs]"


def _tag(arguments: Sequence[str]) -> None:
    parser = _parser("tag", "Give a run tags, each in quotes if it has spaces, or show what is "
                     "said of it. Tags change nothing that is hashed.")  # fmt: skip
    parser.add_argument("key", metavar="KEY", help="the run; the beginning of its key will do")
    parser.add_argument("tags", nargs="*", metavar="TEXT", help="a tag")
    parser.add_argument("--remove", action="store_true", help="take these tags away instead")
    _outputs(parser)
    given = parser.parse_args(list(arguments))
    require(bool(given.tags) or not given.remove, "--remove", "no tag", "which tags")

    def change(said: Said) -> Said:
        if not given.remove:
            return replace(said, tags={**dict.fromkeys(given.tags, now()), **said.tags})
        for tag in given.tags:
            have = ", ".join(said.tags) or "none: it has no tag"
            require(tag in said.tags, "TEXT", tag, have)
        return replace(said, tags={t: w for t, w in said.tags.items() if t not in given.tags})

    _say(given, change)


def _note(arguments: Sequence[str]) -> None:
    parser = _parser("note", "Write a note on a run, in the place of the one that it has.")
    parser.add_argument("key", metavar="KEY", help="the run; the beginning of its key will do")
    parser.add_argument("text", metavar="TEXT", help="any text; '' takes the note away")
    _outputs(parser)
    given = parser.parse_args(list(arguments))
    _say(given, lambda said: replace(said, note=given.text))


def _say(given: argparse.Namespace, change: Callable[[Said], Said]) -> None:
    run = find_run(given.outputs, given.key)
    said = say(run, change)
    told = [*(f"tag {tag}" for tag in said.tags), *([f"note {said.note}"] if said.note else [])]
    print(printable(f"{run.parent.name}/{run.name}: {'; '.join(told) or 'no tag, no note'}"))


def _prune(arguments: Sequence[str]) -> None:
    parser = _parser("prune", "List runs that can go, and remove them with --yes: superseded, "
                     "failed and interrupted ones unless it is said which. What has a tag or a "
                     "note goes only by --tagged.")  # fmt: skip
    parser.add_argument("outputs", type=Path, nargs="?", default=Path("outputs"), help=_WHERE)
    parser.add_argument("--superseded", action="store_true", help="runs in whose place a newer "
                        "one counts, of the same setting, by other code or with more "
                        "trials")  # fmt: skip
    parser.add_argument("--failed", action="store_true", help="runs that failed or were "
                        "interrupted; the command that made one could go on")  # fmt: skip
    parser.add_argument("--tagged", action="append", default=[], metavar="TAG",
                        help="runs with this tag")  # fmt: skip
    parser.add_argument("--yes", action="store_true", help="remove them")
    given = parser.parse_args(list(arguments))
    plain = not (given.superseded or given.failed or given.tagged)
    why = Why(given.superseded or plain, given.failed or plain, set(given.tagged))
    gone, kept = choose(find_runs(given.outputs), why)
    for run, reason in kept:
        _tell(f"stays {run.name}: {reason}")
    total = count = 0
    for run, reason in gone:
        size = size_of(run)
        left = remove(run) if given.yes else []
        if left is None:
            _tell(f"stays {run.name}: another process works on it")
            continue
        count, total = count + 1, total + size
        rest = f"; left in its folder, no part of it: {', '.join(left)}" if left else ""
        print(printable(f"{run.name}  {file_size(size)}  {reason}{rest}"), flush=True)
    end = "removed" if given.yes else "nothing is removed without --yes"
    print(f"{count} runs, {file_size(total)}: {end}")


def _archive(arguments: Sequence[str]) -> None:
    parser = _parser("archive", "Pack the finished runs of an experiment into one file, which "
                     "unpacks into a folder of outputs: tar -xzf FILE -C OUTPUTS.")  # fmt: skip
    parser.add_argument("experiment", metavar="EXPERIMENT", help="a folder of OUTPUTS")
    parser.add_argument("file", type=Path, metavar="FILE", help="NAME.tar.gz, not there yet")
    _outputs(parser)
    given = parser.parse_args(list(arguments))
    packed = pack(given.outputs, given.experiment, given.file)
    for run in packed.left_out:
        _tell(f"left out {run.name}: {run.fault}")
    size = file_size(given.file.stat().st_size)
    print(printable(f"{given.file}: {len(packed.runs)} runs, {size}"))


def _tell(line: str) -> None:
    print(printable(line), file=sys.stderr, flush=True)


_COMMANDS: Mapping[str, Callable[[Sequence[str]], None]] = {
    "tag": _tag, "note": _note, "prune": _prune, "archive": _archive,
}  # fmt: skip
