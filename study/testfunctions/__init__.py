"""The papers' benchmark functions, and their shifted and rotated forms."""

from study.testfunctions.benchmark import Benchmark, random_rotation, rotated, shifted
from study.testfunctions.papers import benchmarks_of

__all__ = ["Benchmark", "benchmarks_of", "random_rotation", "rotated", "shifted"]
