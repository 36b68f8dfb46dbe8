"""Conformance tests and random problems for everyone who writes a planner or a search."""

from study.testing.conformance import NonconformingError, check_bound, check_planner, check_search
from study.testing.problems import example_problems, random_problem

__all__ = ["NonconformingError", "check_bound", "check_planner", "check_search", "example_problems", "random_problem"]
