"""``gapath-log picture`` and ``movie``: a trial as the library draws it, from its log alone."""

import argparse
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from gapath.commands.viewing.told import drawn, told_trial
from gapath.driving.retold import Drive
from gapath.errors import require
from gapath.pictures.shown import png_of
from gapath.recorders import mcap
from gapath.store.durable import scratch, write_whole

if TYPE_CHECKING:
    from gapath.pictures.animation import Animation
    from gapath.pictures.shown import Axes

_MOST = 240
"""Pictures of a movie: half a minute."""

_KINDS = (".webp", ".gif", ".mp4")


def add_trial(parser: argparse.ArgumentParser) -> None:
    """Add the option that says which trial."""
    parser.add_argument("--trial", type=int, default=0, metavar="N", help="which (default: 0)")


def add_options(parser: argparse.ArgumentParser, what: str) -> None:
    """Add the options that the two commands share."""
    add_trial(parser)
    parser.add_argument("-o", "--output", type=Path, metavar="OUT", help=what)


def picture(path: Path, limits: mcap.Limits, arguments: argparse.Namespace) -> Path:
    """Draw a trial as a PNG: its end, or one step of a drive, one epoch of a plan.

    Parameters
    ----------
    path : Path
        The log.
    limits : Limits
        What it may take.
    arguments : argparse.Namespace
        ``trial``, ``step`` (None: the end) and ``output`` (None: beside the log).

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If there is no such trial, step or epoch, or the file cannot be written.
    """
    number, step = arguments.trial, arguments.step
    default = f"trial-{number}.png" if step is None else f"trial-{number}-step-{step}.png"
    output = arguments.output or path.with_name(default)
    require(output.suffix.lower() == ".png", "--output", output, "a file name .png")
    told = drawn(*told_trial(path, number, limits))
    draw: Callable[[Axes], object] = told.plot
    if step is not None:
        animation = told.animate()
        first, last = (0, told.steps) if isinstance(told, Drive) else (1, told.epochs)
        what = "step" if isinstance(told, Drive) else "epoch"
        require(first <= step <= last, "--step", step, f"{what} {first} to {last} of this trial")

        def draw(axes: "Axes") -> None:
            animation.scene(axes)(step - first)

    write_whole(output, png_of(draw))
    return output


def movie(path: Path, limits: mcap.Limits, arguments: argparse.Namespace) -> Path:
    """Draw a trial as a movie of at most half a minute.

    Parameters
    ----------
    path : Path
        The log.
    limits : Limits
        What it may take.
    arguments : argparse.Namespace
        ``trial``, and ``output`` (None: a WebP beside the log).

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If there is no such trial, it has no course, such as A*'s plan, or the file cannot be
        written.
    """
    output = arguments.output or path.with_name(f"trial-{arguments.trial}.webp")
    good = output.suffix.lower() in _KINDS
    require(good, "--output", output, f"a file name {', '.join(_KINDS)}")
    told = drawn(*told_trial(path, arguments.trial, limits))
    with scratch() as folder:
        file = folder / f"movie{output.suffix}"
        _watched(told.animate(_MOST)).save(file)
        write_whole(output, file.read_bytes())
    return output


def _watched(animation: "Animation") -> "Animation":
    """Show a bar while pictures are drawn, if the error stream is a terminal."""
    from tqdm import tqdm

    def scene(axes: "Axes") -> Callable[[int], None]:
        show = animation.scene(axes)
        bar = tqdm(total=len(animation.moments), unit="picture", leave=False, disable=None)

        def counted(moment: int) -> None:
            show(moment)
            bar.update()

        return counted

    return replace(animation, scene=scene)
