"""The study's conformance tests, run on one's own planner and search."""

from outside_planner import SHRINKING_STEPS, ChordRule, ShrinkingSteps, StopAndGo

from study.testing import check_planner, check_search


def test_the_rule_keeps_the_contract() -> None:
    """The rule is a planner."""
    check_planner(ChordRule())


def test_the_path_keeps_the_contract() -> None:
    """A path of one's own is a planner too."""
    check_planner(StopAndGo())


def test_the_search_keeps_the_contract() -> None:
    """The search is one, and makes a planner."""
    check_search(ShrinkingSteps())
    check_planner(SHRINKING_STEPS)
