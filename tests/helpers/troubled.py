"""Shared by the tests: a job that goes wrong, in a file that a worker imports in no time."""

import os
import signal
import time
from dataclasses import dataclass
from typing import ClassVar

from study.reproduction.jobs import RecordJob


@dataclass(frozen=True)
class TroubledJob(RecordJob):
    """A job that crashes its process, hangs or raises."""

    trouble: str
    kind: ClassVar[str] = "troubled"
    weight: ClassVar[float] = 1.0

    @property
    def time_limit(self):
        """Of a job that hangs, which is waited for, a short one."""
        return 0.5 if self.trouble == "hang" else 60.0

    def run(self):
        endings = {"crash": lambda: os.kill(os.getpid(), signal.SIGSEGV), "hang": lambda: time.sleep(99)}
        endings.get(self.trouble, lambda: [][1])()
