"""From a printed number and ours to a verdict: the comparisons, one function for each kind of number."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

import numpy as np

from study.cases.printed import parsed
from study.errors import StudyError
from study.reproduction.sampling import Statistic, rank_sum, resampled, smaller
from study.reproduction.verdicts import Basis, Outcome, Ruling

FACTOR = 10.0
"""Results of random runs are of the same order within this factor."""

ZERO = 1e-162
"""Below this a number is numerically zero: its square is no longer a double."""

NEAR = 1e-3
"""Share of a time within which two times are the same, whatever their scatter."""

SCATTER = 0.05
"""Share of a time beyond which no scatter of ours makes a printed time a reproduced one."""

ABOUT = 0.25
"""Share within which a count of generations agrees that the paper calls approximate."""

ROUGHLY = 0.05
"""Share within which a number agrees that the paper calls approximate."""

POINTS = 1.0
"""Percentage points within which a reduction of ours is the printed one."""

ROUGH_WORDS = ("about", "around", "approximately", "nearly")


def half_unit(printed: str) -> float:
    """Half a unit of the last printed digit: 0.005 for `3.59`, 5e-96 times 0.001 for `7.657 x 10^-96`."""
    text = printed.replace("−", "-").replace(",", "").replace("×", "x")
    match = re.search(r"\d+(?:\.(\d+))?(?:\s*x\s*10\^(-?\d+)|e([+-]?\d+))?", text, re.IGNORECASE)
    if match is None:
        return 0.0
    exponent = int(match[2] or match[3] or 0)
    return 0.5 * 10.0 ** (exponent - len(match[1] or ""))


def digits(printed: str) -> int:
    """Significant digits of a printed number."""
    match = re.search(r"\d[\d,.]*", printed)
    return max(1, len(re.sub(r"\D", "", match[0]).lstrip("0"))) if match else 1


def number(value: float, significant: int = 4) -> str:
    """Our number as text."""
    return f"{value:.{significant}g}"


def alike(text: str, value: float) -> str:
    """Our number in the notation of the print: as a power of ten, as a float of a program, or plain."""
    if value == 0.0 or not ("x 10^" in text or re.search(r"\de[+-]?\d", text)):
        return number(value)
    mantissa, exponent = f"{value:.3e}".split("e")
    return f"{mantissa} x 10^{int(exponent)}" if "x 10^" in text else f"{value:.3e}"


def close(printed: float, text: str, ours: float) -> bool:
    """Whether a number that is no random result agrees to half a unit of its last digit."""
    rough = ROUGHLY * abs(printed) if any(word in text for word in ROUGH_WORDS) else 0.0
    return abs(ours - printed) <= max(rough, half_unit(text) * (1 + 1e-9))


def cut_off(printed: float, text: str, ours: float) -> bool:
    """Whether a printed number is ours with its last digits cut off instead of rounded."""
    return abs(ours) >= abs(printed) and ours * printed >= 0 and abs(ours - printed) < 2 * half_unit(text)


def same_order(printed: float, ours: float, zero: float = ZERO) -> bool:
    """Whether two non-negative results of random runs agree: within a factor of ten, or both numerically zero."""
    if printed <= zero and ours <= zero:
        return True
    return printed > 0 and ours > 0 and 1 / FACTOR <= ours / printed <= FACTOR


def stochastic(
    text: str, finals: Sequence[float], statistic: Statistic, runs: int, least: float = 0.0, rounding: float = 0.0
) -> Ruling:
    """Compare a statistic of random runs, smaller being better.

    Parameters
    ----------
    text : str
        As printed.
    finals : sequence of float
        Final values of our runs.
    statistic : Statistic
    runs : int
        Runs behind the print.
    least : float
        The least value possible, from which both are measured; 0 for a standard deviation.
    rounding : float
        Smallest step of the function near its least value in double precision: numbers that are closer are the same.
    """
    printed = value_of(text)
    slack = rounding + (half_unit(text) if printed else 0.0)  # a printed zero is taken as exact
    zero = max(ZERO, slack)
    ours = statistic.of(finals)
    low, high = np.quantile(resampled(finals, statistic, runs), (0.025, 0.975))
    theirs_above, ours_above = max(printed - least, 0.0), max(ours - least, 0.0)
    tiny = max(theirs_above, ours_above) <= zero
    same = abs(ours - printed) <= slack
    near = tiny or same or same_order(theirs_above, ours_above, zero)
    inside = tiny or low - slack <= printed <= high + slack
    spread = f"{alike(text, float(low))} to {alike(text, float(high))}"
    if near:
        outcome = Outcome.REPRODUCED if inside else Outcome.SAME_ORDER
        why = f"95 % of such statistics of {runs} runs: {spread}"
        if tiny:
            why = f"both {'at the least value' if least else 'numerically zero'}"
        elif same and rounding and not low <= printed <= high:
            why = f"closer than the function's values lie in double precision, {rounding:.2g}; {why}"
        return Ruling(outcome, alike(text, ours), why, True, spread=spread)
    ratio = math.inf if theirs_above <= 0 else ours_above / theirs_above
    outcome = Outcome.BETTER if ours_above < theirs_above else Outcome.WORSE
    why = f"ours is {_times(ratio)} the printed {'distance from the least value' if least else 'value'}"
    return Ruling(outcome, alike(text, ours), why, False, spread=spread)


def exact(text: str, ours: float, basis: Basis, why: str = "") -> Ruling:
    """Compare a number that does not depend on chance.

    Parameters
    ----------
    text : str
        As printed.
    ours : float
        What other printed numbers or a formula give.
    basis : Basis
        `Basis.PRINT` or `Basis.FORMULA`.
    why : str
        The calculation.
    """
    printed, shown = value_of(text), number(0.0 if abs(ours) < 1e-9 * half_unit(text) else ours, 6)
    if close(printed, text, ours):
        return Ruling(Outcome.CONSISTENT, shown, why, True, basis=basis)
    if cut_off(printed, text, ours):
        reason = "; ".join(filter(None, (why, "its digits are cut off, not rounded")))
        return Ruling(Outcome.CONSISTENT, shown, reason, True, basis=basis)
    return Ruling(Outcome.CONTRADICTS, shown, why or f"computed {shown}", False, basis=basis)


def duration(
    text: str, totals: Sequence[float], why: str = "", statistic: Statistic = Statistic.ONE, runs: int = 1
) -> Ruling:
    """Compare a total time with our feasible motions, in s.

    Parameters
    ----------
    text : str
        As printed.
    totals : sequence of float, s
        Of our feasible runs.
    why : str
    statistic : Statistic
        What the paper prints: the time of one run, the mean or the best of several.
    runs : int
        Runs behind the print.
    """
    printed = value_of(text)
    samples = resampled(totals, statistic, runs)
    low, middle, high = (float(value) for value in np.quantile(samples, (0.05, 0.5, 0.95)))
    slack, share = half_unit(text), middle / printed - 1
    spread = f"{low:.4f} to {high:.4f} s"
    reason = "; ".join(filter(None, (f"middle 90 % {spread}", why)))
    shown = f"{middle:.4f} s"
    if abs(share) <= NEAR or abs(middle - printed) <= slack:
        return Ruling(Outcome.REPRODUCED, shown, reason, True, spread=spread)
    if low - slack <= printed <= high + slack:
        outcome = Outcome.REPRODUCED if abs(share) <= SCATTER else Outcome.UNDECIDED
        return Ruling(outcome, shown, f"ours is {100 * share:+.2f} %; {reason}", abs(share) <= SCATTER, spread=spread)
    outcome = Outcome.BETTER if middle < printed else Outcome.WORSE
    return Ruling(outcome, shown, f"ours is {100 * share:+.2f} %; {reason}", False, spread=spread)


def reduction(text: str, before: Sequence[float], after: Sequence[float], against: bool = False) -> Ruling:
    """Compare a printed reduction in per cent with that of our runs.

    Parameters
    ----------
    text : str
        As printed.
    before, after : sequences of float, s
        Totals of our feasible runs; a single one before optimisation.
    against : bool
        Whether it is a reduction against another search, which has to be significant.
    """
    ours = 100 * (1 - float(np.median(after)) / float(np.median(before)))
    agrees = abs(ours - value_of(text)) <= POINTS and not (against and not smaller(after, before)[0])
    outcome = Outcome.REPRODUCED if agrees else Outcome.BETTER if ours > value_of(text) else Outcome.WORSE
    tested = f"; rank-sum test p = {rank_sum(after, before):.2g}" if against else ""
    low, high = np.quantile(100 * (1 - np.asarray(after) / float(np.median(before))), (0.05, 0.95))
    spread = f"{low:.2f} to {high:.2f} %"
    medians = f"by the medians of our runs, {np.median(before):.4f} and {np.median(after):.4f} s"
    return Ruling(outcome, f"{ours:.2f} %", f"{medians}; middle 90 % {spread}{tested}", agrees, spread=spread)


def count(text: str, levels: Mapping[str, float], late: Sequence[str] = ()) -> Ruling:
    """Compare a number of generations with ours at every definition of convergence.

    Parameters
    ----------
    text : str
        As printed, with its words: `within`, `first` and `fewer than` bound it above, `at least` below.
    levels : mapping of a share of the descent to our generations
    late : sequence of str
        Shares at which our runs still descended when their budget ended.
    """
    printed = value_of(text.replace("10-20", "20"))
    at_most = any(word in text for word in ("within", "first", "fewer", "10-20"))
    low = 0.0 if at_most else printed if "least" in text else printed / (1 + ABOUT)
    high = printed if at_most else math.inf if "least" in text else printed * (1 + ABOUT)
    agreeing = [level for level, ours in levels.items() if low <= ours <= high]
    shown = " / ".join(f"{'≥ ' if level in late else ''}{number(ours)}" for level, ours in levels.items())
    where = f"agrees at {', '.join(agreeing)} of the descent" if agreeing else "agrees at none of the four definitions"
    outcome = Outcome.REPRODUCED if agreeing else Outcome.NOT_CONFIRMED
    return Ruling(outcome, shown, f"{where}; ours at {', '.join(levels)}", bool(agreeing))


def holds(statement: bool, ours: str, why: str = "", basis: Basis = Basis.RUNS) -> Ruling:
    """Rule on a statement that our runs, or a formula, bear out or do not."""
    good = Outcome.REPRODUCED if basis in (Basis.RUNS, Basis.FITTED) else Outcome.CONSISTENT
    return Ruling(good if statement else Outcome.NOT_CONFIRMED, ours, why, statement, basis=basis)


def impossible(inequality: str) -> Ruling:
    """Rule that an inequality of arithmetic fails."""
    return Ruling(Outcome.IMPOSSIBLE, why=inequality, basis=Basis.PRINT)


def contradicts(why: str, ours: str = "", basis: Basis = Basis.PRINT) -> Ruling:
    """Rule that printed numbers disagree."""
    return Ruling(Outcome.CONTRADICTS, ours, why, False, basis=basis)


def value_of(text: str) -> float:
    """First number in a printed text, units and words left aside.

    Raises
    ------
    StudyError
        If there is none.
    """
    match = re.search(r"-?\d[\d,]*\.?\d*(?:\s*x\s*10\^-?\d+|e[+-]?\d+)?", text.replace("−", "-"))
    value = None if match is None else parsed(match[0].replace(",", ""))
    if value is None:
        raise StudyError(f"reproduction: {text!r} holds no number to compare with")
    return value


def _times(ratio: float) -> str:
    return "above a printed zero, not a multiple of" if math.isinf(ratio) else f"{ratio:.2g} times"
