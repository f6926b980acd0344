"""Where a run comes from: what its manifest says of that, and the diffs beside it."""

import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import TypeAlias

from gapath.store.keys import code_hash, edited
from gapath.store.provenance.git import is_tracked, top_of, tree_of
from gapath.store.provenance.machine import machine, packages, peak_memory
from gapath.store.settings import Flat

Provenance: TypeAlias = Mapping[str, Flat]
"""Sections, each of which has a value a name."""

DIFF, GAPATH_DIFF = "code.diff", "gapath.diff"
"""Files beside a run: what was changed in the repository of the working directory, and of gapath's
own if that is another."""

PACKAGES = "packages"
"""The section with a value for each that is installed."""

_PACKAGE = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Origin:
    """Where a run comes from, from the moment on when it begins.

    Parameters
    ----------
    said : mapping
        What is known then.
    files : mapping of str to bytes
        Files to be written beside the run: name -> content.
    begun, used : float
        Clocks: of the time, which never goes back, and of this process's processor time, seconds.
    """

    said: Provenance
    files: Mapping[str, bytes]
    begun: float = field(default_factory=time.monotonic)
    used: float = field(default_factory=time.process_time)

    def ended(self, taken_up: int) -> Provenance:
        """Say where a run comes from that is done.

        Parameters
        ----------
        taken_up : int
            Trials that the same run had done before it was cut short.

        Returns
        -------
        mapping
            Nothing where nothing is to be said.
        """
        if not self.said:
            return {}
        spent = {
            "wall_s": round(time.monotonic() - self.begun, 3),
            "cpu_s": round(time.process_time() - self.used, 3),
            "peak_memory_bytes": peak_memory(),
            "trials_taken_up": taken_up,
        }
        return {**self.said, "spent": spent}


def origin_of(asker: Flat, device: str) -> Origin:
    """Find out where a run comes from that begins now.

    Parameters
    ----------
    asker : mapping
        Who asked for it.
    device : str
        What computes it.

    Returns
    -------
    Origin
        Its sections: directory, what git says of the working directory, and gapath, of gapath's
        own source (`gapath.store.provenance.git.Tree`); machine; asker; packages.
    """
    clocks, files = Origin({}, {}), dict[str, bytes]()
    here, own = _here(), _checkout()
    directory = _code(here, DIFF, files) if here else {"told": "no repository"}
    source: Flat = {"told": "an installed package, no checkout"}
    if own is not None:
        source = directory if own == here else _code(own, GAPATH_DIFF, files)
    said = {
        "directory": directory,
        "gapath": {**source, "code": code_hash(), "edited": edited(code_hash())},
        "machine": {**machine(), "device": device},
        "asker": dict(asker),
        PACKAGES: packages(),
    }
    return Origin(said, files, clocks.begun, clocks.used)


def _code(top: Path, name: str, files: dict[str, bytes]) -> Flat:
    tree = tree_of(top)
    if not tree.diff:
        return tree.said
    files[name] = tree.diff
    return {**tree.said, "diff": name}


def _here() -> Path | None:
    """Find the repository of the working directory."""
    with suppress(OSError):  # it may be gone
        return top_of(Path.cwd())
    return None


@lru_cache
def _checkout() -> Path | None:
    """Find the repository that gapath's own source is part of."""
    top = top_of(_PACKAGE)
    return top if top and is_tracked(top, _PACKAGE / "__init__.py") else None
