"""Numbers and sentences of a bench, shared by the terminal and the page."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from statistics import median

from study.analysis.formatting import ratio, wall
from study.bench.measuring import Measurement, unmet
from study.bench.run import Bench

HEAD = ("measured", "against", "ours", "times as fast", "least - most", "target", "")


def cells(row: Measurement) -> tuple[str, ...]:
    """Texts of one row of the table, in the order of its head."""
    target = "" if row.target is None else f"at least {ratio(row.target)}"
    target = target if row.most is None else f"at most {wall(row.most)}"
    if row.missing:
        return row.name, row.peer, row.missing, "", "", target, "not measured"
    cost = f"{wall(median(row.seconds))} per {row.unit}"
    values, shown = (row.ratios, ratio) if row.peer_seconds else (row.seconds, wall)
    spread = f"{shown(min(values))} - {shown(max(values))}"
    times = ratio(row.middle) if row.peer_seconds else ""
    return row.name, row.peer, cost, times, spread, target, {None: "", True: "met", False: "not met"}[row.met]


def topics(rows: Sequence[Measurement]) -> Iterator[tuple[str, list[Measurement]]]:
    """Rows by topic, in their order."""
    for topic in dict.fromkeys(row.topic for row in rows):
        yield topic, [row for row in rows if row.topic == topic]


def summary(bench: Bench) -> list[str]:
    """Sentences that say what was met and what was not."""
    judged = [row for row in bench.rows if row.met is not None]
    failed = unmet(bench.rows)
    absent = [row for row in bench.rows if row.missing]
    texts = [f"{len(judged) - len(failed)} of {len(judged)} targets are met."]
    for row in failed:
        name, peer, cost, ratio, _, target, _ = cells(row)
        against = f" against {peer}" if peer else ""
        texts.append(f"Not met: {row.topic.lower()}, {name}{against}: {ratio or cost}, target {target}.")
    if absent:
        texts.append(f"Not measured: {'; '.join(dict.fromkeys(f'{row.name}: {row.missing}' for row in absent))}.")
    if bench.compile_seconds:
        ready = ", ".join(f"{name} {wall(value)}" for name, value in bench.compile_seconds.items())
        texts.append(f"Kernels were ready after (compiled, or read from numba's cache): {ready}.")
    texts.append(f"The process held at most {bench.peak_bytes / 2**20:,.0f} MiB.")
    return texts


READING = (
    "Times are processor seconds of one thread; what is compared takes turns within each repetition. The middle column "
    "is the median of the ratios, then their least and most.",
    "The papers' way values one candidate and one joint at a time: a 14 x 14 system for 3-5-3, a library's interpolation "
    "for the spline, rates at 100 times per segment. Ours are exact extrema.",
    "Search overhead is the time per evaluation with an objective that costs next to nothing. Ours take their compiled "
    "steps, where they have any and numba is there.",
    "End to end, the targets are those of a cell's repetitions as one batch; a single run stands beside them without any.",
)
