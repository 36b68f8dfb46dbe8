"""`python -m tests.fuzz [READER ...] [--seconds N] [--clock N] [--seed N] [--keep FOLDER]`: spoilt files for every reader, and figures.

Each reader works in a process of its own. Every input must end as a value or a `StudyError` of one line, within 5 s of
processor time and 1 GB of memory; ends with 1 where one does not.
"""

from __future__ import annotations

import argparse
import resource
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from contextlib import ExitStack, suppress
from pathlib import Path
from types import FrameType

import hypothesis
from hypothesis import HealthCheck, Phase, Verbosity, settings
from hypothesis.errors import FlakyStrategyDefinition

from tests.fuzz.files import spoilt
from tests.fuzz.targets import READERS, prepared, target

SLOW = 5.0
"""Processor time that an input may take, s."""

MEMORY = 1_000_000_000
"""Memory that a reader's process may take, bytes."""

ROUND = 500
HEADER = f"{'reader':<12}{'inputs':>9}{'read':>9}{'refused':>9}{'tracebacks':>12}{'slowest, s':>12}{'memory, MB':>12}{'processor, min':>16}"


class TooSlow(BaseException):
    """Raised into a reader that has used up its processor time."""


class Fuzzer:
    """Counts what becomes of the inputs of one reader, and keeps the first input of every kind of failure."""

    def __init__(self, reader: str, keep: Path) -> None:
        self.reader, self.keep, self.target = reader, keep, target(reader)
        self.read = self.refused = 0
        self.slowest = 0.0
        self.failures: dict[str, int] = {}

    def __call__(self, folder: Path, name: str, content: bytes) -> None:
        """Put one input to the reader."""
        begun, failure = processor_time(), ""
        signal.setitimer(signal.ITIMER_PROF, SLOW)
        try:
            refused = bool(self.target(folder, name, content))
            self.refused += refused
            self.read += not refused
        except (Exception, TooSlow) as error:
            place = traceback.extract_tb(error.__traceback__)[-1]
            ours = [
                f
                for f in traceback.extract_tb(error.__traceback__)
                if "/study/" in f.filename or "/baselines/" in f.filename
            ]
            place = ours[-1] if ours else place
            failure = f"{type(error).__name__} at {Path(place.filename).name}:{place.lineno}"
            failure += "" if isinstance(error, TooSlow) else f": {str(error)[:100]!r}"
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
        spent = processor_time() - begun
        self.slowest = max(self.slowest, spent)
        if not failure and spent > SLOW:
            failure = "slow"
        if not failure and memory() > MEMORY and not any(kind.startswith("memory") for kind in self.failures):
            failure = "memory"
        if failure:
            kind = failure.split("'")[0]
            self.failures[kind] = self.failures.get(kind, 0) + 1
            if self.failures[kind] == 1:
                file = self.keep / f"{self.reader}-{len(self.failures)}-{name}"
                file.write_bytes(content)
                print(f"  {self.reader}: {failure}\n    kept as {file}", flush=True)

    def run(self, seconds: float, clock: float, seed: int) -> None:
        """Put inputs to the reader until so much processor time is spent, so much time has gone by, or SIGTERM comes."""
        signal.signal(signal.SIGPROF, interrupt)
        signal.signal(signal.SIGTERM, self.stop)
        with ExitStack() as stack:
            folder = prepared(self.target, stack)
            begun, round_number = processor_time(), 0
            self.end, self.until = begun + seconds, time.monotonic() + clock
            while self.going():
                self._round(folder, seed * 1_000_003 + round_number)
                round_number += 1
        self.minutes = (processor_time() - begun) / 60

    def stop(self, number: int, frame: FrameType | None) -> None:
        """Handle the signal to end after this input; the figures are told all the same."""
        self.end = 0.0

    def going(self) -> bool:
        """Whether there is time for another input."""
        return processor_time() < self.end and time.monotonic() < self.until

    def _round(self, folder: Path, seed: int) -> None:
        @hypothesis.seed(seed)
        @settings(
            max_examples=ROUND, database=None, deadline=None, phases=[Phase.generate],
            suppress_health_check=list(HealthCheck), verbosity=Verbosity.quiet,
        )  # fmt: skip
        @hypothesis.given(spoilt(self.target.seeds))
        def inputs(file: tuple[str, bytes]) -> None:
            if self.going():
                self(folder, *file)

        with suppress(
            FlakyStrategyDefinition
        ):  # how deep an edit may nest depends on the stack; the next round goes on
            inputs()

    @property
    def line(self) -> str:
        """Figures of this reader."""
        failed = sum(self.failures.values())
        return (
            f"{self.reader:<12}{self.read + self.refused + failed:>9,}{self.read:>9,}{self.refused:>9,}{failed:>12,}{self.slowest:>12.2f}"
            f"{memory() / 1e6:>12.0f}{self.minutes:>16.2f}"
        )


def processor_time() -> float:
    """Processor time of this process and of those that it has started and waited for, s."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def memory() -> int:
    """Largest memory of this process so far, bytes; without that of its parent, which getrusage counts on Linux."""
    status = Path("/proc/self/status")
    if status.is_file():
        return next(1024 * int(line.split()[1]) for line in status.read_text().splitlines() if line.startswith("VmHWM"))
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def interrupt(number: int, frame: FrameType | None) -> None:
    """Handle the signal of a reader that has used up its processor time."""
    raise TooSlow


def main() -> int:
    """Fuzz the readers that are asked for, one after the other."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("readers", nargs="*", metavar="READER", help=f"any of {', '.join(READERS)}; all by default")
    parser.add_argument("--seconds", type=float, default=8.0, help="processor time for each reader")
    parser.add_argument(
        "--clock", type=float, default=float("inf"), help="seconds after which a reader ends all the same"
    )
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, help="folder for inputs that fail")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if unknown := set(given.readers) - set(READERS):
        parser.error(f"no reader {', '.join(unknown)}; there are {', '.join(READERS)}")
    keep = given.keep or Path(tempfile.mkdtemp(prefix="fuzz-"))
    keep.mkdir(parents=True, exist_ok=True)
    if given.inside:
        warnings.simplefilter("error")  # a warning would stand on the screen with a line of source
        resource.setrlimit(resource.RLIMIT_DATA, (4 * MEMORY, resource.RLIM_INFINITY))
        fuzzer = Fuzzer(given.readers[0], keep)
        fuzzer.run(given.seconds, given.clock, given.seed)
        print(fuzzer.line, flush=True)
        return bool(fuzzer.failures)
    print(HEADER, flush=True)
    status = 0
    for reader in given.readers or READERS:
        numbers = {"--seconds": given.seconds, "--clock": given.clock, "--seed": given.seed, "--keep": keep}
        options = [*(str(word) for pair in numbers.items() for word in pair), "--inside"]
        ended = subprocess.run([sys.executable, "-m", "tests.fuzz", reader, *options])
        if ended.returncode not in (0, 1):
            print(f"  {reader}: the process ended with {ended.returncode}")
        status |= ended.returncode != 0
    print("every input ended as a value or in one sentence" if not status else f"inputs that did not are in {keep}")
    return status


if __name__ == "__main__":
    sys.exit(main())
