"""What git says of a folder: which commit it is at, and what was changed since.

The repository may be a stranger's, so that it is only looked at. No command that its own
configuration names is run (hooks, monitors of the file system, filters, other programs for
diffs), nothing is fetched, its index is not written, and its files are those around its ``.git``.
What it takes is bounded. What cannot be told is told so; nothing raises.
"""

import os
import re
import time
from pathlib import Path
from subprocess import DEVNULL, PIPE, Popen
from threading import Timer
from typing import NamedTuple

from gapath.errors import printable
from gapath.store.settings import Flat, Value

MOST_DIFF = 1 << 18
"""Bytes of a diff that is kept: every run of a sweep has its own."""

_PATIENCE = 5.0  # seconds for all that is asked of a repository
_MOST_SAID = 1 << 22  # bytes of an answer
_FEW, _LONG = 20, 100
"""Untracked files that are named, and characters of such a name."""

_SHARE = 100
"""Looking takes so small a part of the time of a sweep at most: a hundredth."""

_OWN = ("local", "worktree")
"""Where settings come from that are the repository's own."""

_FILTER = re.compile(r"(filter\..+)\.(?:clean|smudge|process|required)", re.DOTALL)

_KEPT = ("GIT_CONFIG_GLOBAL", "GIT_CONFIG_SYSTEM", "GIT_CONFIG_NOSYSTEM")
"""What is kept of the environment that steers git: in a hook it speaks of another repository."""

_HARMLESS = {
    "core.fsmonitor": "false",
    "core.hooksPath": os.devnull,
    "safe.bareRepository": "explicit",
}

_DIFF = ("diff", "--no-ext-diff", "--no-textconv", "--no-color", "--no-renames", "--binary",
         "--full-index", "--src-prefix=a/", "--dst-prefix=b/", "--submodule=short",
         "--ignore-submodules=dirty", "HEAD", "--")  # fmt: skip
_STATUS = ("status", "--porcelain=v2", "--branch", "-z", "--no-renames", "--untracked-files=normal",
           "--ignore-submodules=dirty")  # fmt: skip


class Tree(NamedTuple):
    """The files of a repository, as they are.

    Parameters
    ----------
    said : dict of str to str, int, bool or None
        commit; clean, whether every file that git knows is as committed; untracked, how many
        files and folders git does not know, and untracked_names, some of them; told, what could
        not be found out.
    diff : bytes
        What was changed since the commit; empty if nothing, or it is not kept.
    """

    said: dict[str, Value]
    diff: bytes = b""


def commit_of(said: Flat | None) -> str | None:
    """Name the commit of a tree as git does, with "-dirty" behind it if files were changed."""
    if not said or not said.get("commit"):
        return None
    return printable(said["commit"]) + ("" if said.get("clean") else "-dirty")


class _Silent(Exception):
    """Git gives no answer: why."""


def top_of(folder: Path) -> Path | None:
    """Find the repository that a folder is in: the nearest folder upwards that has a ``.git``."""
    return next((p for p in (folder, *folder.parents) if os.path.lexists(p / ".git")), None)


def tree_of(top: Path) -> Tree:
    """Look at a repository, or recall a look that was a moment ago.

    Parameters
    ----------
    top : Path
        Its folder (`top_of`).

    Returns
    -------
    Tree
        As it is, or was not more than a hundred times as long ago as looking takes.
    """
    begun = time.monotonic()
    if top not in _looked or _looked[top][1] < begun:
        tree, end = _look(top), time.monotonic()
        _looked[top] = tree, end + _SHARE * (end - begun)
    return _looked[top][0]


_looked: dict[Path, tuple[Tree, float]] = {}


def is_tracked(top: Path, file: Path) -> bool:
    """Tell whether a repository has a file: what it ignores may lie in it, too."""
    try:
        return bool(_Questions(top).ask("ls-files", "-z", "--", os.fspath(file)))
    except _Silent:
        return False


def _look(top: Path) -> Tree:
    said: dict[str, Value] = {}
    try:
        questions = _Questions(top)
        if questions.unfiltered:
            said["told"] = f"its own filters were not run: {', '.join(questions.unfiltered)}"
        lines = [os.fsdecode(line) for line in questions.ask(*_STATUS).split(b"\0")]
        commit = _after("# branch.oid ", lines)[0]
        others = _after("? ", lines)
        said["commit"] = None if commit == "(initial)" else commit
        said["clean"] = not any(line.startswith(("1 ", "2 ", "u ")) for line in lines)
        said["untracked"] = len(others)
        said["untracked_names"] = ", ".join(name[:_LONG] for name in others[:_FEW])
        if said["clean"] or not said["commit"]:
            return Tree(said)
        return Tree(said, questions.ask(*_DIFF, most=MOST_DIFF))
    except _Silent as reason:
        told = (str(said["told"]), str(reason)) if "told" in said else (str(reason),)
        return Tree({**said, "told": "; ".join(told)})


def _after(word: str, lines: list[str]) -> list[str]:
    return [line.removeprefix(word) for line in lines if line.startswith(word)]


class _Questions:
    """Asks git about a repository, for so long in all."""

    def __init__(self, top: Path) -> None:
        self._top, self._end = top, time.monotonic() + _PATIENCE
        kept = {n: v for n, v in os.environ.items() if not n.startswith("GIT_") or n in _KEPT}
        self._environment = {
            **kept,
            "LC_ALL": "C",
            "GIT_WORK_TREE": os.fspath(top),
            "GIT_CEILING_DIRECTORIES": os.fspath(top.parent),
            "GIT_OPTIONAL_LOCKS": "0",
            "GIT_TERMINAL_PROMPT": "0",
            "GIT_ALLOW_PROTOCOL": "none",
            "GIT_NO_LAZY_FETCH": "1",
        }
        self._set(_HARMLESS)
        said = self.ask("config", "--list", "--show-scope", "--name-only", "-z").split(b"\0")
        pairs = zip(map(os.fsdecode, said[::2]), map(os.fsdecode, said[1::2]), strict=False)
        found = (_FILTER.fullmatch(name) for scope, name in pairs if scope in _OWN)
        filters = sorted({match[1] for match in found if match})
        self.unfiltered = [name.removeprefix("filter.")[:_LONG] for name in filters[:_FEW]]
        off = {f"{name}.{part}": "" for name in filters for part in ("clean", "smudge", "process")}
        self._set(_HARMLESS | off | {f"{name}.required": "false" for name in filters})

    def _set(self, settings: dict[str, str]) -> None:
        """Have settings of ours in the place of the repository's."""
        self._environment["GIT_CONFIG_COUNT"] = str(len(settings))
        for i, (name, value) in enumerate(settings.items()):
            self._environment |= {f"GIT_CONFIG_KEY_{i}": name, f"GIT_CONFIG_VALUE_{i}": value}

    def ask(self, what: str, *words: str, most: int = _MOST_SAID) -> bytes:
        """Give git's answer; raises _Silent without one, or with one of more than `most` bytes."""
        try:
            process = Popen(
                ["git", what, *words], cwd=self._top, env=self._environment, stdin=DEVNULL,
                stdout=PIPE, stderr=DEVNULL,
            )  # fmt: skip
        except (OSError, ValueError) as error:
            missing = isinstance(error, FileNotFoundError) and self._top.is_dir()
            reason = "git is not installed" if missing else f"git cannot be run: {error}"
            raise _Silent(reason) from error
        with process:
            clock = Timer(max(0.0, self._end - time.monotonic()), process.kill)
            clock.start()
            try:
                assert process.stdout is not None
                said = process.stdout.read(most + 1)
                if len(said) > most:
                    process.kill()
                code = process.wait()
            finally:
                clock.cancel()
                process.kill()
        if len(said) > most:
            raise _Silent(f"git {what} says more than {most} bytes, which are not kept")
        if time.monotonic() >= self._end:
            raise _Silent(f"git takes longer than {_PATIENCE:g} s")
        if code:
            raise _Silent(f"git {what} fails with exit code {code}")
        return said
