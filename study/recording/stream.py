"""The explicit recording stream and the few things that every part of a recording needs."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import rerun as rr

from study.errors import StudyError
from study.files import replacing

APPLICATION = "time-optimal-study"
TIMELINE = "t"
EVALUATION = "evaluation"
GENERATION = "generation"
LIMIT_COLOR = (200, 60, 60)
SIGNALS = ("q", "v", "a", "jerk")


def entity(*parts: str) -> str:
    """Join names into an entity path; characters that mean something in a path are escaped."""
    return rr.new_entity_path([part or "unnamed" for part in parts])


def method_part(label: str) -> str:
    """Part of an entity path for a method; a leading underscore is kept for what is no method, such as limits."""
    return f"method {label}" if label.startswith("_") else label


def time_column(times: np.ndarray) -> list[rr.TimeColumn]:
    """Index of whole nanoseconds on the timeline `t`."""
    return [rr.TimeColumn(TIMELINE, duration=np.asarray(times, dtype=np.int64).astype("timedelta64[ns]"))]


@contextmanager
def strict() -> Iterator[None]:
    """Make rerun raise on wrong shapes instead of dropping the data with a warning."""
    before = rr.strict_mode()
    rr.set_strict_mode(True)
    try:
        yield
    finally:
        rr.set_strict_mode(before)


@contextmanager
def recording_file(path: Path, recording: str) -> Iterator[rr.RecordingStream]:
    """Open a recording that appears under its name only when it is complete and closed.

    Raises
    ------
    StudyError
        If it cannot be written whole, or logging is switched off by the environment variable RERUN.
    """
    try:
        with replacing(path) as part:
            part.write_bytes(b"")
            with strict(), rr.RecordingStream(APPLICATION, recording_id=recording, send_properties=False) as stream:
                if not rr.is_enabled(stream):
                    raise StudyError(f"recording {path}: rerun is switched off; unset the environment variable RERUN")
                stream.save(part)
                rr.set_log_time_enabled(False, recording=stream)
                yield stream
    except RuntimeError as error:  # rerun's own, as of a full disk
        raise StudyError(f"recording {path} cannot be written: {error}; choose another folder") from None
