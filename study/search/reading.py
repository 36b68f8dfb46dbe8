"""Readings of a paper: a search to the printed letter, or as the paper must be meant."""

from __future__ import annotations

from study.choices import Choice


class PaperReading(Choice):
    """Reading in which a search is offered where its paper cannot be meant to the letter."""

    AS_PRINTED = "as-printed"
    STANDARD = "standard"
