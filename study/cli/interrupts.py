"""Ways in which a command ends early: Ctrl-C at any moment, and a standard output that takes no more."""

from __future__ import annotations

import errno
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

STATUS = 130
"""Exit status after Ctrl-C, as shells count: 128 and the number of the signal."""


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
