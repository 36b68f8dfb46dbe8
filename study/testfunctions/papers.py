"""Benchmark functions of the three papers that have them, as printed and as they must be meant.

References
----------
Woodworking paper, Table 2; UR5 paper on SMWOA, Table 2; PUMA560 paper, Table 2.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from study.errors import unknown
from study.problem import Floats
from study.search.reading import PaperReading
from study.testfunctions import formulas
from study.testfunctions.benchmark import Benchmark, Formula

Edge = float | Sequence[float]


def _benchmark(
    label: str, formula: Formula, box: tuple[Edge, Edge], n: int, best: tuple[float | None, Edge | None] = (0.0, 0.0)
) -> Benchmark:
    """Make a benchmark; numbers stand for equal coordinates."""
    minimum, where = best
    lower, upper = (np.broadcast_to(np.asarray(edge, dtype=float), n) for edge in box)
    minimiser = None if where is None else np.broadcast_to(np.asarray(where, dtype=float), n)
    name = formula.__name__.replace("_", "-")
    noise = 1.0 if formula is formulas.quartic else 0.0
    return Benchmark(name, label, formula, lower, upper, minimum, minimiser, noise)


WOODWORKING = (
    _benchmark("F1", formulas.sphere, (-100, 100), 30),
    _benchmark("F2", formulas.schwefel_222, (-10, 10), 30),
    _benchmark("F3", formulas.schwefel_221, (-100, 100), 30),
    _benchmark("F4", formulas.step, (-100, 100), 30),
    _benchmark("F5", formulas.quartic, (-1.28, 1.28), 30),
    _benchmark("F6", formulas.ackley, (-32, 32), 30),
    _benchmark("F7", formulas.griewank, (-600, 600), 30),
    _benchmark("F8", formulas.penalised_2, (-50, 50), 30, (0.0, 1.0)),
)


def squared_222(x: Floats) -> Floats:
    """Woodworking paper, F2, as printed: |x_i^2| in the place of |x_i|."""
    return formulas.schwefel_222(x**2)


def squared_221(x: Floats) -> Floats:
    """Woodworking paper, F3, as printed: |x_i^2| in the place of |x_i|."""
    return formulas.schwefel_221(x**2)


WOODWORKING_PRINTED = (
    _benchmark("F2", squared_222, (-10, 10), 30),
    _benchmark("F3", squared_221, (-100, 100), 30),
    _benchmark("F4", formulas.step_without_floor, (-100, 100), 30, (0.0, -0.5)),
    _benchmark("F8", formulas.penalised_2_product, (-50, 50), 30, (0.0, 1.0)),
)

_FOXHOLES = (0.99800383779445, (-31.978330712590456, -31.97833157692572))
_BRANIN = (0.39788735772973816, (np.pi, 2.275))
_HARTMANN = (-3.8627821478207554, (0.11461434256750598, 0.555648851025697, 0.8525469528860454))
_SHEKEL = (-10.153199679058229, (4.000037152376549, 4.000133278657566, 4.000037151057555, 4.000133277090425))
_KOWALIK = (
    0.0003074859878056052,
    (0.19283345283555905, 0.19083623751410211, 0.12311729382972839, 0.13576599015052346),
)

SMWOA = (
    _benchmark("F1", formulas.sphere, (-100, 100), 30),
    _benchmark("F2", formulas.schwefel_222, (-10, 10), 30),
    _benchmark("F3", formulas.schwefel_12, (-100, 100), 30),
    _benchmark("F4", formulas.schwefel_221, (-100, 100), 30),
    _benchmark("F5", formulas.rosenbrock, (-30, 30), 30, (0.0, 1.0)),
    _benchmark("F6", formulas.rastrigin, (-5.12, 5.12), 30),
    _benchmark("F7", formulas.ackley, (-32, 32), 30),
    _benchmark("F8", formulas.alpine, (-10, 10), 30),
    _benchmark("F9", formulas.penalised_1, (-50, 50), 30, (0.0, -1.0)),
    _benchmark("F10", formulas.penalised_2, (-50, 50), 30, (0.0, 1.0)),
    _benchmark("F11", formulas.foxholes, (-65.536, 65.536), 2, _FOXHOLES),
    _benchmark("F12", formulas.branin, ((-5, 0), (10, 15)), 2, _BRANIN),
    _benchmark("F13", formulas.goldstein_price, (-2, 2), 2, (3.0, (0, -1))),
    _benchmark("F14", formulas.hartmann_3, (0, 1), 3, _HARTMANN),
    _benchmark("F15", formulas.shekel_5, (0, 10), 4, _SHEKEL),
)

# F9's first sine has no square, so that its least value is below 0: 10 sin(pi y) + (y - 1)^2 at y near 1.49.
_PENALISED_1_PRINTED = (-1.0215376332576882, (0.960270178957896, *[-1.0] * 29))

SMWOA_PRINTED = (
    _benchmark("F7", formulas.ackley_with_six, (-32, 32), 30, (6.0 - np.e, 0.0)),
    _benchmark("F9", formulas.penalised_1_printed, (-50, 50), 30, _PENALISED_1_PRINTED),
    _benchmark("F10", formulas.penalised_2_printed, (-50, 50), 30, (0.0, 1.0)),
    _benchmark("F11", formulas.foxholes_printed, (-65.536, 65.536), 2, (None, None)),
    _benchmark("F12", formulas.branin, (-5, 5), 2, _BRANIN),
)

# The dimension n is not printed; 30 is ours, as in the other two papers. F5's a_i lacks its second index.
PUMA560 = (
    _benchmark("F1", formulas.rosenbrock, (-30, 30), 30, (0.0, 1.0)),
    _benchmark("F2", formulas.step, (-100, 100), 30),
    _benchmark("F3", formulas.ackley, (-32, 32), 30),
    _benchmark("F4", formulas.griewank, (-600, 600), 30),
    _benchmark("F5", formulas.foxholes, (-65, 65), 2, _FOXHOLES),
    _benchmark("F6", formulas.kowalik, (-5, 5), 4, _KOWALIK),
)

_TABLES: dict[str, tuple[tuple[Benchmark, ...], tuple[Benchmark, ...]]] = {
    "woodworking-golds-pso": (WOODWORKING, WOODWORKING_PRINTED),
    "ur5-smwoa": (SMWOA, SMWOA_PRINTED),
    "puma560-chaotic-spso": (PUMA560, ()),
}


def benchmarks_of(paper: str, reading: PaperReading | str = PaperReading.STANDARD) -> tuple[Benchmark, ...]:
    """List a paper's benchmark functions in its order.

    Parameters
    ----------
    paper : str
        Key of the paper, such as `ur5-smwoa`.
    reading : PaperReading
        Or its text: `standard` as they must be meant, or `as-printed` wherever the print differs and can be computed.

    Raises
    ------
    StudyError
        If the paper has no benchmark functions or there is no such reading.
    """
    if paper not in _TABLES:
        raise unknown("benchmark functions for the paper", paper, _TABLES)
    meant, printed = _TABLES[paper]
    replaced = (
        {function.label: function for function in printed} if PaperReading(reading) is PaperReading.AS_PRINTED else {}
    )
    return tuple(replaced.get(function.label, function) for function in meant)
