"""Run the RRT paper's whole pipeline over many worlds and count how often its final motion collides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from study.errors import StudyError
from study.planners.rrt_spso import ROBOT, attempt
from study.planning import RunSettings, Synchronisation
from study.reproduction.jobs import Record, RecordJob
from study.robots import robot_named

CHUNK = 10
"""Worlds in one job."""


@dataclass(frozen=True)
class PathJob(RecordJob):
    """The pipeline in some worlds.

    Attributes
    ----------
    pathfinder : str
        A name in `study.planners.rrt_spso.METHODS`.
    first, count : int
        Seeds of the worlds.
    population, generations : int
        Of the search for durations.
    """

    pathfinder: str
    first: int
    count: int
    population: int
    generations: int
    kind: ClassVar[str] = "path"
    weight: ClassVar[float] = 12.0

    @property
    def subject(self) -> str:
        """Name of the robot."""
        return ROBOT

    @property
    def method(self) -> str:
        """Name of the pathfinder."""
        return self.pathfinder

    def inputs(self) -> object:
        """Return the robot."""
        return robot_named(ROBOT)

    def run(self) -> Record:
        """Clearances, durations and path lengths, world by world; a world without a motion counts as failed."""
        gathered: Record = {"tool": [], "chords": [], "duration": [], "length": [], "failed": []}
        for seed in range(self.first, self.first + self.count):
            settings = RunSettings(
                "poly353",
                seed,
                self.population * self.generations,
                self.population,
                synchronisation=Synchronisation.PER_JOINT,
            )
            try:
                tried = attempt(self.pathfinder, seed, settings)
            except StudyError as error:
                gathered["failed"].append(f"world {seed}: {error}")
                continue
            gathered["tool"].append(tried.tool_clearance)
            gathered["chords"].append(tried.chord_clearance)
            gathered["duration"].append(tried.motion.duration)
            gathered["length"].append(tried.path_length)
        return gathered


def attempts(method: str, worlds: int, population: int, generations: int) -> list[PathJob]:
    """Jobs that together cover so many worlds."""
    return [
        PathJob(method, first, min(CHUNK, worlds - first), population, generations) for first in range(0, worlds, CHUNK)
    ]
