"""Pages from templates: one way for the report and for the packages that put pages of their own beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from study.report.plot_style import STROKES, color_properties

REPORT = "study.report"
Filters = Mapping[str, Callable[..., object]]


def render(
    template: str, context: Mapping[str, object], package: str = REPORT, filters: Filters = MappingProxyType({})
) -> str:
    """Fill in a template; it can use the report's own ones, and the report's style sheet and script as `css` and `js`.

    Parameters
    ----------
    template : str
    context : mapping of str to object
        What it is given; text is escaped.
    package : str
        Whose folder `templates` it is in.
    filters : mapping of str to callable, optional
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
    source = {name: Markup(report.get_source(environment, f"report.{name}")[0]) for name in ("css", "js")}  # noqa: S704
    return environment.get_template(template).render(**source, **context)
