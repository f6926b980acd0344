"""The command `gapath-report`."""

import argparse
import gc
import logging
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import gapath
from gapath.errors import InputError, printable, require_extra

_EPILOG = """\
commands:
  gapath-report OUTPUTS [-o DIR]   write the report
  gapath-report runs [OUTPUTS]     list the run folders, and answer questions about them:
                                   gapath-report runs --help
  gapath-report compare [OUTPUTS]  say which of two or more groups of runs is best, and from
                                   which others it can be told apart: compare --help
  gapath-report watch [OUTPUTS]    follow sweeps that are under way: watch --help
  gapath-report tag KEY TEXT...    give a run tags; note KEY TEXT: a note
  gapath-report prune [OUTPUTS]    list runs that can go, and remove them: prune --help
  gapath-report archive EXPERIMENT FILE
                                   pack an experiment's runs into one file

Runs that cannot be used are named, with the reason, and left out. A folder that is itself
called "runs" or as another command is given as ./runs.
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command `gapath-report`.

    Parameters
    ----------
    argv : sequence of str, optional
        The arguments; those of the process by default.

    Returns
    -------
    int
        The exit code: 0, 2 for a folder that holds nothing to report.
    """
    arguments = list(sys.argv[1:] if argv is None else argv)
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # where its cache lies is no news
    try:
        if arguments[:1] == ["runs"]:
            require_extra("runs", "report")
            from gapath.pipelines.asking import command  # pandas takes half a second to start

            with _no_collection():
                command.main(arguments[1:])
        elif arguments[:1] == ["compare"]:
            require_extra("compare", "report")
            from gapath.pipelines.compare import command as comparing

            with _no_collection():
                comparing.run(arguments[1:])
        elif arguments[:1] == ["watch"]:
            from gapath.pipelines.report import watch

            watch.main(arguments[1:])
        elif arguments[:1] and arguments[0] in ("tag", "note", "prune", "archive"):
            from gapath.pipelines.keeping import command as keeping

            keeping.main(arguments)
        else:
            chosen = _report_parser().parse_args(arguments)
            _report(chosen.outputs, chosen.output or chosen.outputs / "report")
    except InputError as error:
        print(f"gapath-report: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        if isinstance(error, BrokenPipeError):  # `gapath-report runs | head`
            sys.stderr.close()
            return 0
        where, found = error.filename or "output", error.strerror or error
        right = "a file or folder that can be read, or written"
        print(f"gapath-report: {InputError(where, found, right)}", file=sys.stderr)
        return 2
    return 0


@contextmanager
def _no_collection() -> Iterator[None]:
    """Look for no garbage: ten thousand records are none, and it takes a fifth of the time."""
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def _report_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "gapath-report",
        description="Make tables (CSV, Markdown, LaTeX), figures (SVG, PNG) and a web page from "
        "whatever runs are there; another one, bench.html, if OUTPUTS/bench has benchmarks.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("outputs", type=Path, help="folder with <experiment>/<key>/, as `gapath` "
                        "writes it")  # fmt: skip
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="where to write "
                        "[OUTPUTS/report]")  # fmt: skip
    version = f"gapath-report {gapath.__version__}"
    parser.add_argument("--version", action="version", version=version)
    return parser


def _report(outputs: Path, folder: Path) -> None:
    require_extra("a report", "report")
    # pandas and matplotlib take a second to start
    from gapath.pipelines.report.report import make_report

    files, skipped = make_report(outputs, folder)
    for run, reason in skipped:
        print(printable(f"left out {run}: {reason}"), file=sys.stderr)
    print(printable(f"{len(files)} files in {folder}"))
    print(printable(f"open {files[-1].resolve()}"))
