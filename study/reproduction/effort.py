"""Extent of the runs: the papers' own settings, or a quick look."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Effort:
    """Seeds and budgets of a reproduction.

    Attributes
    ----------
    label : str
        Stands on every page.
    seeds : int
        Runs of every benchmark cell and trajectory planner; the papers have 30.
    share : float
        Share of the papers' generations.
    attempts : int
        Seeds of the RRT pipeline.
    all_readings : bool
        Run the readings beside the stated one.
    """

    label: str
    seeds: int
    share: float = 1.0
    attempts: int = 100
    all_readings: bool = True

    def generations(self, printed: int) -> int:
        """Generations to run where the paper has `printed`."""
        return max(2, round(self.share * printed))


FULL = Effort("full: the papers' budgets, 30 seeds, 100 worlds", 30)
QUICK = Effort("quick: the papers' budgets with 4 seeds, 4 worlds, the stated readings only", 4, 1.0, 4, False)
