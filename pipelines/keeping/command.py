"""The commands `gapath-report tag`, `note`, `prune` and `archive`."""

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

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
    _DONE_BY[name](parser(name).parse_args(rest))


def parser(name: str) -> argparse.ArgumentParser:
    """Make the parser of a command's arguments."""
    made = argparse.ArgumentParser(f"gapath-report {name}", description=_ABOUT[name])
    add = made.add_argument
    if name in ("tag", "note"):
        add(
            "key",
            metavar="KEY",
            help="the run: the beginning of its key, its folder or a file in that",
        )
    if name == "tag":
        add("tags", nargs="*", metavar="TEXT", help="a tag")
        add("--remove", action="store_true", help="take these tags away instead")
    elif name == "note":
        add("text", metavar="TEXT", help="any text; '' takes the note away")
    elif name == "archive":
        add("experiment", metavar="EXPERIMENT", help="a folder of DIR")
        add("file", type=Path, metavar="FILE", help="NAME.tar.gz, not there yet")
    else:
        add("--superseded", action="store_true", help="runs in whose place a newer one counts, of "
            "the same setting, by other code or with more trials")  # fmt: skip
        add("--failed", action="store_true", help="runs that failed or were interrupted; the "
            "command that made one could go on")  # fmt: skip
        add("--tagged", action="append", default=[], metavar="TAG", help="runs with this tag")
        add("--yes", action="store_true", help="remove them")
    place: dict[str, Any] = {"nargs": "?"} if name == "prune" else {"metavar": "DIR"}
    add("outputs" if name == "prune" else "--outputs", type=Path, default=Path("outputs"),
        help="folder with <experiment>/<key>/ [outputs]", **place)  # fmt: skip
    return made


_ABOUT = {
    "tag": "Give a run tags, each in quotes if it has spaces, or show what is said of it. Tags "
    "change nothing that is hashed.",
    "note": "Write a note on a run, in the place of the one that it has.",
    "prune": "List runs that can go, and remove them with --yes: superseded, failed and "
    "interrupted ones unless it is said which. What has a tag or a note goes only by --tagged.",
    "archive": "Pack the finished runs of an experiment into one file, which unpacks into a "
    "folder of outputs: tar -xzf FILE -C DIR.",
}


def _tag(given: argparse.Namespace) -> None:
    require(bool(given.tags) or not given.remove, "--remove", "no tag", "which tags")

    def change(said: Said) -> Said:
        if not given.remove:
            return replace(said, tags={**dict.fromkeys(given.tags, now()), **said.tags})
        for tag in given.tags:
            have = ", ".join(said.tags) or "none: it has no tag"
            require(tag in said.tags, "TEXT", tag, have)
        return replace(said, tags={t: w for t, w in said.tags.items() if t not in given.tags})

    _say(given, change)


def _note(given: argparse.Namespace) -> None:
    _say(given, lambda said: replace(said, note=given.text))


def _say(given: argparse.Namespace, change: Callable[[Said], Said]) -> None:
    run = find_run(given.outputs, given.key)
    said = say(run, change)
    told = [*(f"tag {tag}" for tag in said.tags), *([f"note {said.note}"] if said.note else [])]
    print(printable(f"{run.parent.name}/{run.name}: {'; '.join(told) or 'no tag, no note'}"))


def _prune(given: argparse.Namespace) -> None:
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


def _archive(given: argparse.Namespace) -> None:
    packed = pack(given.outputs, given.experiment, given.file)
    for run in packed.left_out:
        _tell(f"left out {run.name}: {run.fault}")
    size = file_size(given.file.stat().st_size)
    print(printable(f"{given.file}: {len(packed.runs)} runs, {size}"))


def _tell(line: str) -> None:
    print(printable(line), file=sys.stderr, flush=True)


_DONE_BY = {"tag": _tag, "note": _note, "prune": _prune, "archive": _archive}
