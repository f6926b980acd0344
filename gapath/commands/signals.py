"""Control-C and SIGTERM end a command at once, with one line, whatever it is doing.

Python itself tells the main thread, between two lines of Python: not while a kernel or a library's
machine code runs, and in the middle of whatever comes next, such as an import. Here the system's
handler wakes another thread, which kernels let run beside them, and that ends the process as a
kill would: run folders are safe against it (`gapath.store.whole`). Whoever imports gapath keeps
the handlers that there are; only `gapath.__main__` asks for these.
"""

import os
import select
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress

PATIENCE = 0.4
"""Seconds for last words, should a disk be slow; a second signal does not wait for them."""

_WORDS = {int(signal.SIGINT): "interrupted", int(signal.SIGTERM): "terminated"}


@contextmanager
def watched(command: str, kept: str = "") -> Iterator[None]:
    """End this process on either signal meanwhile, with exit code 128 + its number.

    One that was ignored, as Control-C is of jobs in the background of a script, still is. One that
    comes later, while Python ends, comes too late: all is done and said.

    Parameters
    ----------
    command : str
        Its name, for the line on standard error; empty of a process that another speaks for.
    kept : str
        What that line says more: what is safe.
    """
    read, write = os.pipe()
    os.set_blocking(write, False)
    signal.set_wakeup_fd(write, warn_on_full_buffer=False)
    ending = threading.Lock()  # the command, or a signal: who has it keeps it
    line = f"{command}: {{}}{kept}" if command else ""
    threading.Thread(target=_wait, args=(line, read, ending), daemon=True).start()
    for number in _WORDS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, lambda *given: None)  # Python writes into the pipe
    try:
        yield
    finally:
        ending.acquire()  # else a signal ends the process
        for number in _WORDS:
            signal.signal(number, signal.SIG_IGN)  # Python takes back all other handlers


@contextmanager
def following(over: Callable[[], bool], process: int | None) -> Iterator[None]:
    """Work for another process: what that one is told by a signal ends this one, too, silently.

    Between two pieces of work this process ends with the other one, or with the one that started
    it, as it may wait for a lock that nobody gives back.

    Parameters
    ----------
    over : callable
        Tells whether the other process is gone, however it ended.
    process : int or None
        Its number, if it is of this machine: it may be gone, and this one be nobody's child, by
        the time that it begins to work.
    """
    parent = os.getppid()
    new = not _followed
    _followed[:] = [over]
    if new and threading.current_thread() is threading.main_thread():
        _worker.enter_context(watched(""))
        threading.Thread(target=_follow, daemon=True).start()
    try:
        yield
    finally:
        _followed[:] = [lambda: os.getppid() != parent or not _lives(process)]


def _lives(process: int | None) -> bool:
    try:
        if process is not None:
            os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:  # it is another user's
        pass
    return True


_followed: list[Callable[[], bool]] = []

_worker = ExitStack()

_LOOK = 0.3  # seconds between looks at the other process


def _follow() -> None:
    while not _followed[0]():
        time.sleep(_LOOK)
    _end("", int(signal.SIGTERM))


def _wait(line: str, read: int, ending: threading.Lock) -> None:
    while (number := os.read(read, 1)[0]) not in _WORDS:
        pass
    ending.acquire()
    try:
        threading.Thread(target=_end, args=(line, number), daemon=True).start()
        select.select([read], [], [], PATIENCE)
    finally:
        os._exit(128 + number)


def _end(line: str, number: int) -> None:
    try:
        if line:
            _tell(line.format(_WORDS[number]))
        durable = sys.modules.get("gapath.store.durable")
        for action in getattr(durable, "LAST", ()):  # what was not imported yet has none
            action()
    finally:
        os._exit(128 + number)


def _tell(line: str) -> None:
    """Write a line, and let no other follow; not through `sys.stderr`, which others may hold."""
    if sys.stderr is None:  # closed when Python started: 2 is another file
        return
    bar = "\r\x1b[K" if os.isatty(2) else ""  # one that stands there goes
    with suppress(OSError, ValueError):
        if select.select([], [2], [], 0)[1]:  # a pipe that nobody empties has no room
            os.write(2, f"{bar}{line}\n".encode())
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
