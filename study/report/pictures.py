"""Pictures of real results for a README: the ladder and one joint's profiles; the viewer's picture is made small."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path

from markupsafe import escape
from PIL import Image

from study.analysis.case_summary import CaseSummary
from study.analysis.featured import ROLE_NAMES
from study.errors import StudyError
from study.files import write_file
from study.report import figures
from study.report.case_page import featured_series, ladder_figure
from study.report.plot_style import STROKES, color_properties

COLORS = 256
"""The viewer's picture is kept small with so many colours."""

WIDTH = 1400
LETTER = 6.6
"""Width of a letter of the legend; a browser's own font is rarely wider."""

FONT = 'font-family="system-ui, Segoe UI, Roboto, DejaVu Sans, sans-serif"'


def pictures_of(summary: CaseSummary, joint: int) -> dict[str, bytes]:
    """Draw `ladder.svg` and `profile.svg` of a case.

    Parameters
    ----------
    summary : CaseSummary
    joint : int
        Joint of the profiles, counted from 0.

    Raises
    ------
    StudyError
        If there is too little to show.
    """
    case, best, near = summary.case, summary.best, featured_series(summary)[1]
    if not summary.rungs or not near:
        raise StudyError(f"case {case.name!r}: too few results for pictures; run `study run --cases {case.name}` first")
    ladder = standalone(str(ladder_figure(summary)), f"The ladder of lost time, case {case.name}", [])
    names = {method.label: ROLE_NAMES[role] for _, role, method in reversed(best.present())}
    legend = [(each.style, f"{names[each.label]}: {each.label.removeprefix('published: ')}") for each in near]
    drawing = figures.profile("profile", case.problem, joint, case.units[joint], near)
    profile = standalone(str(drawing), f"{case.problem.joint_names[joint]}, case {case.name}", legend)
    return {"ladder.svg": ladder.encode(), "profile.svg": profile.encode()}


def midway(summary: CaseSummary) -> float:
    """Time at which every motion of the profiles is still under way, s."""
    return min(each.motion.duration for each in featured_series(summary)[1]) / 2


def write_pictures(folder: Path, name: str, contents: Mapping[str, bytes]) -> list[Path]:
    """Write pictures, `NAME-` before the name of each.

    Raises
    ------
    StudyError
        If the folder cannot be written.
    """
    return [write_file(folder / f"{name}-{file}", content) for file, content in contents.items()]


def standalone(svg: str, title: str, legend: Sequence[tuple[int, str]]) -> str:
    """Make a figure of a page a file of its own: light colours, a ground, a title and a legend.

    Parameters
    ----------
    svg : str
        As `study.report.plot_style.themed` makes it.
    title : str
    legend : sequence of (style, name)
    """
    colors = _light_colors()
    width, height = (float(text) for text in re.findall(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', svg)[0])
    top = 34.0 + 18.0 * len(legend)
    inner = re.sub(
        r'style="max-width:[^"]*"', f'x="0" y="{top}" width="{width}" height="{height}" {FONT}', svg, count=1
    )
    lines = [f'<text x="14" y="22" font-size="14" font-weight="bold" fill="var(--ink)" {FONT}>{escape(title)}</text>']
    for row, (style, name) in enumerate(legend):
        y = 44.0 + 18.0 * row
        stroke = f'stroke="var(--s{style + 1})" stroke-width="2" stroke-dasharray="{STROKES[style]}"'
        lines.append(f'<path d="M14 {y - 4}h40" fill="none" {stroke}/>')
        lines.append(f'<text x="62" y="{y}" font-size="12" fill="var(--ink)" {FONT}>{escape(name)}</text>')
    across = max([width, *(76.0 + LETTER * len(name) for _, name in legend)])
    whole = (
        f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
        f'viewBox="0 0 {across:g} {height + top}" width="{across:g}" height="{height + top}">'
        f'<rect width="100%" height="100%" fill="var(--paper)"/>{"".join(lines)}{inner}</svg>\n'
    )
    return re.sub(r"var\(--(\w+)\)", lambda match: colors[match[1]], whole)


def small(png: bytes) -> bytes:
    """Shrink a picture of the viewer until it is fit for a repository."""
    image = Image.open(io.BytesIO(png)).convert("RGB")
    image = image.resize((WIDTH, round(image.height * WIDTH / image.width)), Image.Resampling.LANCZOS)
    out = io.BytesIO()
    image.quantize(COLORS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(out, "PNG", optimize=True)
    return out.getvalue()


def _light_colors() -> dict[str, str]:
    """Colours of the report's style sheet on light ground, by the names of its custom properties."""
    sheet = files("study.report").joinpath("templates/report.css").read_text(encoding="utf-8")
    return dict(re.findall(r"--(\w+): (#\w+)", sheet[: sheet.index("}")] + color_properties(dark=False)))
