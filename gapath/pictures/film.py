"""Pictures as a film, by a program that may be there."""

import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from PIL import Image

from gapath.errors import InputError

PROGRAM = "ffmpeg"


def ffmpeg() -> str:
    """Give the program that makes films; raises InputError if there is none."""
    program = shutil.which(PROGRAM)
    if program is None:
        raise InputError("animation", f"no {PROGRAM}", f"{PROGRAM} on the path, or .webp or .gif")
    return program


def mp4_of(program: str, frames: Sequence[Image.Image], rate: float) -> bytes:
    """Make an MP4 of pictures; the same ones give the same bytes with the same ffmpeg.

    Parameters
    ----------
    program : str
        Where ffmpeg is.
    frames : sequence of Image
        All of one size.
    rate : float
        Pictures a second.

    Returns
    -------
    bytes
        The file.

    Raises
    ------
    InputError
        If ffmpeg fails.
    """
    width, height = frames[0].size
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", f"{rate:g}"]
    even = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p"]
    same = ["-threads", "1", "-fflags", "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1"]
    with tempfile.TemporaryDirectory() as folder:
        film = Path(folder) / "film.mp4"
        command = [program, "-loglevel", "error", "-y", *raw, "-i", "-", *even, *same, str(film)]
        pictures = b"".join(frame.convert("RGB").tobytes() for frame in frames)
        done = subprocess.run(command, input=pictures, capture_output=True)
        if done.returncode:
            told = done.stderr.decode(errors="replace").strip().splitlines() or ["no word"]
            raise InputError("animation", f"{PROGRAM}: {told[-1]}", "one that can make an MP4")
        return film.read_bytes()
