"""What a GPU is to those that use it; without the package that finds one."""

from typing import NamedTuple


class Card(NamedTuple):
    """What computes: a GPU, or what stands for one."""

    name: str
    blocks: int
    """Blocks of threads, at most."""
    threads: int
    """Threads of a block, at most."""
    memory: int
    """Bytes that a launch may take."""
