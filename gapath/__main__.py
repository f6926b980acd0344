"""The commands as they are started: first of all they learn how to end (`gapath.commands.signals`).

What they import takes a second, so each imports its own only then.
"""

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from gapath.commands.signals import watched


@contextmanager
def _begun(command: str, kept: str = "") -> Iterator[None]:
    """Watch for signals; exit with code 2 where there is no working directory.

    Libraries ask for it while they are imported.
    """
    with watched(command, kept):
        try:
            Path.cwd()
        except OSError as error:
            print(f"{command}: the working directory: {error.strerror}", file=sys.stderr)
            sys.exit(2)
        yield


def main() -> int:
    """Run the command `gapath`: a run, or what its first word names.

    Returns
    -------
    int
        Exit code of what does no run; a run exits by itself.
    """
    first, *rest = sys.argv[1:] or [""]
    if first in ("-sc", "--shell-completion") and rest and rest[0].startswith("query="):
        from gapath.commands.told.completing import complete

        return complete(rest[0])
    if first in _COMMANDS or first == "run":
        del sys.argv[1]
    if first in _COMMANDS:
        return _COMMANDS[first]()
    if first in _TOLD:
        return _tell([first, *rest])
    if {"-h", "--help"} & {*sys.argv}:
        return _tell(["--help"])
    _run()
    return 0


_TOLD = ("help", "maps", "planners", "navigators")


def _tell(words: list[str]) -> int:
    with _begun("gapath"):
        from gapath.commands.told.screen import tell

        return tell(words)


def _run() -> None:
    """Run `gapath.commands.run.main`, without collecting what lives as long as it.

    Modules are some hundred thousand objects, none of them garbage. To look for garbage among
    them again and again takes an eighth of a short command's time.
    """
    with _begun("gapath", "; what is done is kept, and the same command goes on"):
        gc.disable()
        from gapath.commands.run import main as command

        gc.freeze()
        gc.enable()
        command()


def log() -> int:
    """Run the command `gapath.commands.log.main`."""
    with _begun("gapath-log"):
        from gapath.commands.log import main as command

        return command()


def report() -> int:
    """Run the command `gapath.pipelines.report.cli.main`."""
    with _begun("gapath-report"):
        from gapath.pipelines.report.cli import main as command

        return command()


def genotype() -> int:
    """Run the command `gapath.commands.genotype.main`."""
    with _begun("gapath-genotype"):
        from gapath.commands.genotype import main as command

        return command()


_COMMANDS = {"log": log, "report": report, "genotype": genotype}
"""First words that are commands of their own, too: ``gapath log`` is ``gapath-log``."""


if __name__ == "__main__":
    sys.exit(main())
