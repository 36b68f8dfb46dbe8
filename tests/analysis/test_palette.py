"""One palette: a method keeps its colour, and no two methods of a figure look alike, to colour-blind eyes either."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from jinja2 import Environment, PackageLoader

from study.analysis.palette import DARK, LIGHT, SLOTS, method_slots, rgb, terminal_color
from study.registry import planner_names
from study.report.plot_style import SERIES, STROKES
from study.runs.selections import COMPARED, HEADLINE_SEARCHES

EYES = {
    "all receptors": np.eye(3),
    "no red": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "no green": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
}
"""What is left of linear red, green and blue (Machado, Oliveira and Fernandes 2009, severity 1)."""
XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)


def linear(colors: list[tuple[int, int, int]]) -> np.ndarray:
    share = np.array(colors) / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def lab(light: np.ndarray) -> np.ndarray:
    """CIE L*a*b* of linear red, green and blue, shape (n, 3)."""
    f = np.cbrt(light @ XYZ.T / [0.95047, 1.0, 1.08883])
    return np.stack([116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])], axis=-1)


@pytest.mark.parametrize(("colors", "eyes"), list(product((LIGHT, DARK), EYES)))
def test_colours_keep_apart(colors: tuple[str, ...], eyes: str) -> None:
    seen = lab(np.clip(linear([rgb(k, colors) for k in range(SLOTS)]) @ np.transpose(EYES[eyes]), 0, 1))
    apart = np.linalg.norm(seen[:, None] - seen, axis=2)[np.triu_indices(SLOTS, 1)]
    assert apart.min() > 15  # a difference of 2.3 is just noticeable


@pytest.mark.parametrize(("colors", "ground"), [(LIGHT, (255, 255, 255)), (DARK, (20, 23, 27))])
def test_colours_stand_out_from_the_ground(colors: tuple[str, ...], ground: tuple[int, int, int]) -> None:
    luminances = linear([ground, *(rgb(k, colors) for k in range(SLOTS))]) @ XYZ[1] + 0.05
    ratios = np.maximum(luminances, luminances[0]) / np.minimum(luminances, luminances[0])
    assert ratios[1:].min() >= 3  # WCAG 2.2, 1.4.11


def test_first_served_methods_have_colours_of_their_own_and_all_methods_different_ones() -> None:
    labels = list(planner_names())
    first = labels[-SLOTS:]
    slots = method_slots(labels, first)
    assert sorted(slots[label] for label in first) == list(range(SLOTS))
    few = method_slots(labels[:30])
    assert len({rgb(slot) for slot in few.values()}) == 30
    assert method_slots(reversed(labels), first) == slots


def test_methods_that_stand_together_often_have_their_own_slot_everywhere() -> None:
    alone = {name: method_slots([name])[name] for name in (*COMPARED, *HEADLINE_SEARCHES)}
    for together in (COMPARED[:5], HEADLINE_SEARCHES[:7]):
        assert len({alone[name] for name in together}) == len(together)
    assert method_slots(["pso:scaled:shared"])["pso:scaled:shared"] == alone["pso"]


def test_a_terminal_takes_the_colour_between_the_two() -> None:
    assert terminal_color(0) == "#{:02x}{:02x}{:02x}".format(
        *((a + b) // 2 for a, b in zip(rgb(0, LIGHT), rgb(0, DARK), strict=True))
    )


def test_every_style_has_a_mark() -> None:
    environment = Environment(loader=PackageLoader("study.report", "templates"), autoescape=True)
    marker = environment.get_template("macros.html.j2", globals={"strokes": STROKES}).module.marker
    marks = [str(marker(style)).strip() for style in range(len(SERIES))]
    assert all(marks)
    assert len(set(marks)) == SLOTS
