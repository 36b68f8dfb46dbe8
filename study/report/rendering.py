"""Pages from templates: one way for the report and for the packages that put pages of their own beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from study.files import write_file
from study.report.plot_style import STROKES, color_properties

REPORT = "study.report"
SCRIPTS = ("assets/uplot.js", "assets/report.js")
Filters = Mapping[str, Callable[..., object]]


def render(
    template: str,
    context: Mapping[str, object],
    package: str = REPORT,
    filters: Filters = MappingProxyType({}),
    root: str = "",
) -> str:
    """Fill in a template; it can use the report's own ones, and the report's style sheet as `css`.

    Parameters
    ----------
    template : str
    context : mapping of str to object
        What it is given; text is escaped.
    package : str
        Whose folder `templates` it is in.
    filters : mapping of str to callable, optional
    root : str
        Way from the page to the report's folder, such as `../`; its scripts are there, see `write_scripts`.
    """
    report = PackageLoader(REPORT, "templates")
    loader = report if package == REPORT else ChoiceLoader([PackageLoader(package, "templates"), report])
    environment = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= filters
    environment.globals |= {
        "strokes": STROKES,
        "light": color_properties(dark=False),
        "dark": color_properties(dark=True),
    }
    sheets = [report.get_source(environment, "report.css")[0], vendored("uPlot.min.css")]
    css = Markup("\n".join(sheets))  # noqa: S704 - our own files
    return environment.get_template(template).render(css=css, root=root, scripts=SCRIPTS, **context)


def vendored(name: str) -> str:
    """Text of a file of uPlot, which draws the figures that answer to the pointer; it is under the MIT licence."""
    return files(REPORT).joinpath("vendor", "uplot", name).read_text(encoding="utf-8")


def write_scripts(report: Path) -> None:
    """Write the scripts of all pages, once, into the report's folder.

    Raises
    ------
    StudyError
        If they cannot be written.
    """
    own = files(REPORT).joinpath("templates", "report.js").read_text(encoding="utf-8")
    licence = "/*\n" + vendored("LICENSE") + "\n*/\n"
    for name, text in zip(SCRIPTS, (licence + vendored("uPlot.iife.min.js"), own), strict=True):
        write_file(report / name, text)
