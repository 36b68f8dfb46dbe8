"""Shared by the tests: jobs of every kind."""

from itertools import zip_longest

from study.comparison.trials import Trial, TrialJob
from study.reproduction.benchmark_runs import BenchmarkJob
from study.reproduction.kinematics_runs import KinematicsJob
from study.reproduction.motion_runs import MotionJob
from study.search.pso import PSO
from study.search.random_search import RandomSearch
from study.search.woa import WOA


def every_kind(cells):
    """Jobs of cells, and mixed among them trials and runs behind papers' numbers."""
    trials = [
        TrialJob(Trial(name, "sphere", "shifted", 0, 200, 10, 4), search, range(3))
        for name, search in {"woa": WOA(), "pso": PSO(), "random": RandomSearch()}.items()
    ]
    runs = [
        BenchmarkJob("woodworking-golds-pso", "F5", "standard", PSO(), 6, 5, 2),
        MotionJob("woodworking", PSO(), 0, 5, 4, 2),
        KinematicsJob(4, 1),
    ]
    return [job for pair in zip_longest(cells, [*trials, *runs]) for job in pair if job is not None]
