"""Make a plotted SVG fit for a page: colours that follow the reader's theme, ids of its own, a title read aloud."""

from __future__ import annotations

import re

from markupsafe import Markup, escape

THEME = {
    "#010101": "ink",
    "#020202": "muted",
    "#030303": "grid",
    "#040404": "band",
    "#050505": "paper",
    "#0a0a01": "s1",
    "#0a0a02": "s2",
    "#0a0a03": "s3",
    "#0a0a04": "s4",
    "#0a0a05": "s5",
    "#0a0a06": "s6",
}
"""Placeholder colours that a figure draws with, and the custom property of the style sheet that takes their place."""

PLACEHOLDER = {name: colour for colour, name in THEME.items()}


def themed(raw: str, key: str, title: str, description: str) -> Markup:
    """Turn a stand-alone SVG file into an inline figure.

    Parameters
    ----------
    raw : str
        What the plotting library wrote.
    key : str
        Letters and digits; put before every id, so that figures on one page do not share any.
    title, description : str
        What a screen reader says; escaped here.
    """
    body = raw[raw.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>\s*", "", body, flags=re.DOTALL)
    body = re.sub(r"<!--.*?-->\s*", "", body, flags=re.DOTALL)
    body = re.sub("|".join(THEME), lambda found: f"var(--{THEME[found[0]]})", body)
    body = re.sub(r"font: ([\d.]+)px [^;\"]*", r"font-size: \1px", body)
    view = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', body)
    width, height = (view[1], view[2]) if view else ("400", "300")
    opening = (
        f'<svg xmlns:xlink="http://www.w3.org/1999/xlink" xmlns="http://www.w3.org/2000/svg" '
        f'viewBox="0 0 {width} {height}" role="img" aria-labelledby="{key}-title {key}-desc" style="max-width:{float(width) * 1.25:.0f}px">'
        f'<title id="{key}-title">{escape(title)}</title><desc id="{key}-desc">{escape(description)}</desc>'
    )
    inside = _own_ids(body[body.index(">") + 1 :], key)
    return Markup(opening + inside.strip())  # noqa: S704 - title and description are escaped above, the rest is plotted


def _own_ids(body: str, key: str) -> str:
    used = set(re.findall(r'(?:url\(#|href="#)([^)"]+)', body))
    body = re.sub(r' id="([^"]+)"', lambda found: f' id="{key}-{found[1]}"' if found[1] in used else "", body)
    return re.sub(r'(url\(#|href="#)', rf"\g<1>{key}-", body)
