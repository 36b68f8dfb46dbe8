"""The two forms in which a search is offered where its paper cannot be meant to the letter."""

from __future__ import annotations

from study.errors import unknown

READINGS = ("as-printed", "standard")


def is_printed(reading: str) -> bool:
    """Tell whether a reading is the paper's letter.

    Raises
    ------
    StudyError
        If there is no such reading.
    """
    if reading not in READINGS:
        raise unknown("reading", reading, READINGS)
    return reading == "as-printed"
