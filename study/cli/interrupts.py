"""Ways in which a command ends early: Ctrl-C at any moment, too little memory, an output that takes no more."""

from __future__ import annotations

import errno
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

from study.errors import StudyError

try:
    import resource
except ImportError:  # not on Windows
    resource = None  # type: ignore[assignment]

STATUS = 130
"""Exit status after Ctrl-C, as shells count: 128 and the number of the signal."""

LEAST_MEMORY = 600_000_000
"""Address space that a process needs to load the numerical libraries, bytes."""


@contextmanager
def ending_at_once() -> Iterator[None]:
    """Let Ctrl-C end the process with one sentence while code is imported, where nothing is lost.

    An import that is interrupted raises whatever the module at work makes of it, so no exception could be relied on.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, _end)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def check_memory() -> None:
    """Make sure that numerical libraries can be loaded; with too little memory some wait for ever.

    Raises
    ------
    StudyError
        If the process may take less than `LEAST_MEMORY`.
    """
    if resource is None:
        return
    allowed, _ = resource.getrlimit(resource.RLIMIT_AS)
    if allowed != resource.RLIM_INFINITY and allowed < LEAST_MEMORY:
        raise StudyError(
            f"this process may take {allowed / 1e6:.0f} MB of memory, its libraries need {LEAST_MEMORY / 1e6:.0f} MB; "
            "raise the limit (`ulimit -v`)"
        )


def _end(number: int, frame: FrameType | None) -> None:
    with suppress(OSError):
        os.write(2, b"study: interrupted\n")
    os._exit(STATUS)


def output_failure(error: OSError) -> str | None:
    """Sentence about a standard output that takes no more, empty where its reader has gone; None for any other error."""
    if error.errno not in (errno.EPIPE, errno.ENOSPC, errno.EIO, errno.EFBIG, errno.EDQUOT):
        return None
    with suppress(OSError, ValueError, AttributeError):  # what waits in the buffer cannot be written at exit either
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return "" if error.errno == errno.EPIPE else f"the output cannot be written: {error.strerror}"
