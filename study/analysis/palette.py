"""The one palette: a method has the same colour in terminal, report and recording."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

Color = tuple[int, int, int]

LIGHT = (
    "#0662b6", "#ee5c00", "#2a8265", "#73247a", "#47505f", "#6b5000",
    "#863934", "#678dbf", "#47a725", "#9a7eec", "#88834f", "#c1378c",
)  # fmt: skip
DARK = (
    "#5badfe", "#fa8d38", "#8df6af", "#ca6a9e", "#f1e6e7", "#fee95b",
    "#e5514b", "#99d1f1", "#b1cc72", "#8a7ac3", "#ada479", "#e0a3ad",
)  # fmt: skip
"""Colours of the slots on light and on dark ground, chosen to keep apart for eyes with and without red or green receptors."""

SLOTS = len(LIGHT)

HOMES = {
    "pso": 0,
    "random-search": 0,
    "casadi-nlp": 1,
    "quintic-nlp": 1,
    "free-path": 2,
    "free-path-nlp": 2,
    "toppra": 3,
    "copp": 3,
    "topp3-nlp": 3,
    "published": 4,
    "cma-es-own-population": 5,
    "l-shade": 5,
    "golds-pso": 6,
    "lbfgsb-once": 6,
    "dynamic-adaptive-pso": 7,
    "ruckig-via": 8,
    "gold-sa": 8,
    "tadf-ssa": 9,
    "ruckig-stops": 9,
    "chaotic-spso": 10,
    "cma-es": 10,
    "smwoa": 11,
    "straight": 11,
}
"""Slots of methods that figures show often; those that stand in one figure differ."""

STEP = 5
"""Stride from a slot that is taken to the next choice; it shares no factor with their number."""

TINTS = (0.0, 0.5, -0.45)
"""Share of white, or where negative of black, mixed into a colour that is given out again."""


def method_slots(labels: Iterable[str], first: Sequence[str] = ()) -> dict[str, int]:
    """Give every method a slot: its own as far as that is free, so that it rarely changes between cases.

    Parameters
    ----------
    labels : iterable of str
        Planners, each with what it does otherwise after a colon.
    first : sequence of str
        Methods that are served first; as many as there are slots have slots of their own.

    Returns
    -------
    dict of str to int
        From `SLOTS` on the colours are tints of the first ones, see `rgb`.
    """
    labels = set(labels)
    slots: dict[str, int] = {}
    for label in (*dict.fromkeys(label for label in first if label in labels), *sorted(labels.difference(first))):
        turn = len(slots) // SLOTS
        taken = {slot % SLOTS for slot in slots.values() if slot // SLOTS == turn}
        home = _home(label)
        slots[label] = turn * SLOTS + next(s for k in range(SLOTS) if (s := (home + k * STEP) % SLOTS) not in taken)
    return slots


def _home(label: str) -> int:
    """Slot that a method would like to have, which depends on its planner's name alone."""
    planner = label.partition(":")[0]
    return HOMES.get(planner, sum(map(ord, planner)) % SLOTS)


def rgb(slot: int, colors: Sequence[str] = DARK) -> Color:
    """Red, green and blue of a slot, from 0 to 255; on dark ground by default, as in the recording."""
    red, green, blue = bytes.fromhex(colors[slot % SLOTS][1:])
    tint = TINTS[slot // SLOTS % len(TINTS)]
    ground = 255 if tint > 0 else 0
    red, green, blue = (round(channel + abs(tint) * (ground - channel)) for channel in (red, green, blue))
    return red, green, blue


def terminal_color(slot: int) -> str:
    """Colour of a slot that reads on dark and on light terminals: halfway between the two, as `#rrggbb`."""
    pairs = zip(rgb(slot, LIGHT), rgb(slot, DARK), strict=True)
    return "#" + "".join(f"{sum(pair) // 2:02x}" for pair in pairs)
