"""What computes: the machine, its system, and what is installed."""

import os
import platform
import re
import resource
import sys
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

from gapath.store.settings import Value

_INSTALLED = re.compile(r"([\w.]{1,100})-([\w.!+]{1,100})(?:-py[\d.]+)?\.(?:dist|egg)-info")
_MOST = 5000  # packages


@lru_cache
def processor() -> str:
    """Name the processor as its maker does, where the system tells."""
    with suppress(OSError):
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
        for line in text.splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


@lru_cache
def machine() -> dict[str, Value]:
    """Describe this machine.

    Returns
    -------
    dict of str to str or int
        host, processor, cpus, cpus_usable (by this process), system, kernel, python.
    """
    kernel, system = os.uname(), ""
    with suppress(OSError):
        system = platform.freedesktop_os_release().get("PRETTY_NAME", "")
    return {
        "host": kernel.nodename,
        "processor": processor(),
        "cpus": os.cpu_count(),
        "cpus_usable": _usable(),
        "system": system or f"{kernel.sysname} {kernel.release}",
        "kernel": f"{kernel.sysname} {kernel.release} {kernel.machine}",
        "python": f"{platform.python_implementation()} {platform.python_version()}",
    }


def _usable() -> int | None:
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on every system
        return os.cpu_count()


@lru_cache
def packages() -> dict[str, Value]:
    """Give all of Python's packages that are installed here: name -> version, sorted.

    Told by the names of the folders that an installer makes: to read what stands in each would
    take a tenth of a second.
    """
    found: dict[str, Value] = {}
    for place in sys.path:
        with suppress(OSError):
            names = sorted(path.name for path in Path(place).iterdir())
            for match in filter(None, map(_INSTALLED.fullmatch, names)):
                name = re.sub(r"[-_.]+", "-", match[1]).lower()
                found.setdefault(name, match[2])  # the first on the path is what is imported
    return dict(sorted(found.items())[:_MOST])


def peak_memory() -> int:
    """Give the most memory that this process has had so far, in bytes."""
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
