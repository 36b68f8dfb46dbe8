"""Numbers as people read them."""

from __future__ import annotations

import math
import re

from markupsafe import Markup, escape

from study.errors import listed as listed
from study.errors import plural as plural

DASH = "–"
UNITS = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))


def seconds(value: float | None) -> str:
    """Time with enough digits to tell neighbours apart."""
    if value is None or not math.isfinite(value):
        return DASH
    return f"{value:.4g} s" if 0 < value < 0.01 else f"{value:.4f} s"


def figures(value: float | None) -> str:
    """Time in s for a table of durations: five decimals, or five digits where it is short."""
    if value is None or not math.isfinite(value):
        return DASH
    return f"{value:.5f}" if value >= 0.01 else f"{value:.5g}"


def change(value: float | None) -> str:
    """Difference of times, with its sign."""
    if value is None or not math.isfinite(value):
        return DASH
    return "0 s" if abs(value) < 5e-5 else f"{value:+.4f} s".replace("-", "−")


def wall(value: float | None) -> str:
    """Wall time with three digits, in the unit that suits it."""
    if value is None or not math.isfinite(value):
        return DASH
    size, unit = next((each for each in UNITS if value >= each[0]), UNITS[-1])
    return f"{value / size:.0f} {unit}" if value / size >= 99.5 else f"{value / size:.3g} {unit}"


def ratio(value: float) -> str:
    """Ratio with three digits: plain below ten thousand, then as a power of ten."""
    if 999.5 <= value < 9999.5:
        return f"{value:.0f}"
    return f"{value:.3g}" if value < 1000 else f"{value:.0e}".replace("e+0", "e").replace("e+", "e")


def bare_seconds(value: float | None) -> str:
    """Time without its unit, for a column that names it."""
    return seconds(value).removesuffix(" s")


def percent(fraction: float | None, signed: bool = True) -> str:
    """Fraction as a percentage: two digits after the point below ten percent, one above."""
    if fraction is None or not math.isfinite(fraction):
        return DASH
    value = 100.0 * fraction
    digits = 2 if abs(value) < 9.995 else 1
    if 1e-4 <= abs(value) < 0.005:
        return "≈ 0 %"
    text = f"{value:+.{digits}f}" if signed else f"{value:.{digits}f}"
    return "0 %" if float(text) == 0 else text.replace("-", "−") + " %"


def share(ratio: float | None) -> str:
    """Share of a limit, with the digits that show a small excess."""
    if ratio is None or not math.isfinite(ratio):
        return DASH
    return f"{ratio:.6f}" if 1e-6 < ratio - 1 < 5e-5 else f"{ratio:.4f}"


def count(value: float | None) -> str:
    """Whole number with thin spaces between thousands."""
    return DASH if value is None else f"{value:,.0f}".replace(",", "\u202f")


def coded(text: str) -> Markup:
    """Text for a page, with what stands between backticks as code."""
    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(text))))  # noqa: S704 - escaped first
