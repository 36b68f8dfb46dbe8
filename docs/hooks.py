"""Fill the pages' generated parts from the program itself: the ledger, the planners and the schema's fields."""

from __future__ import annotations

import ast
import html
import json
import re
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from latex2mathml.converter import convert
from mkdocs.structure.files import File, Files

from study import JointLimits, Planned, Problem, plan
from study.bench import figures, wording
from study.bench.run import read
from study.bounds import kind_of
from study.cases.ledger import ledger
from study.cases.own_file import schema
from study.cases.suite_file import filed_suites
from study.cases.suites import suite_named
from study.cli.main import commands_with_names
from study.registry import method_named, method_names, peer_names
from study.suites.law import committed_law
from study.suites.records import records_table
from study.suites.tables import results_in_markdown


def on_page_markdown(markdown: str, **kwargs: Any) -> str:
    """Replace the marks that stand for generated parts."""
    for mark, part in {
        "ledger": _ledger,
        "planners": _planners,
        "fields": _fields,
        "bench": _bench,
        "rooms": _rooms,
        "law": lambda: committed_law(suite_named("scaling")),
        "second law": lambda: committed_law(suite_named("scaling-second")),
        "records": lambda: "\n\n".join(f"### {name}\n\n{records_table(suite_named(name))}" for name in filed_suites()),
        "card": lambda: _example()._repr_html_(),
        "plot": lambda: _example().plot("elbow")._repr_svg_(),
    }.items():
        if f"<!-- {mark} -->" in markdown:
            markdown = markdown.replace(f"<!-- {mark} -->", part())
    markdown = re.sub(r"<!-- options: (.*) -->", lambda mark: _options(mark[1]), markdown)
    markdown = re.sub(r"<!-- results: (.*) -->", lambda mark: results_in_markdown(suite_named(mark[1])), markdown)
    if "$" not in markdown or kwargs["page"].file.name not in ("mathematics", "searches", "suites"):
        return markdown
    markdown = re.sub(r"\$\$(.+?)\$\$", lambda found: _formula(found[1], "block"), markdown, flags=re.DOTALL)
    markdown = re.sub(r"\n *\$", " $", markdown)  # a line that begins with a formula would count as a block of HTML
    return re.sub(r"\$(.+?)\$", lambda found: _formula(found[1], "inline"), markdown, flags=re.DOTALL)


def _formula(latex: str, display: str) -> str:
    """MathML, which browsers draw by themselves: nothing is fetched."""
    return convert(" ".join(latex.split()), display=display).replace("\n", " ")


def on_files(files: Files, config: Any, **kwargs: Any) -> Files:
    """Let the pages show the pictures that stand beside them."""
    for path in sorted((Path(__file__).parent / "pictures").iterdir()):
        files.append(File.generated(config, f"pictures/{path.name}", abs_src_path=str(path)))
    return files


@cache
def _example() -> Planned:
    """Plan two joints through four waypoints, in milliseconds."""
    waypoints = np.array([[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]])
    limits = JointLimits(np.array([1.0, 0.8]), np.array([2.0, 1.5]), np.array([20.0, 15.0]))
    return plan(Problem("mine", waypoints, limits, joint_names=["base", "elbow"]), "fast")


def on_post_build(config: Any, **kwargs: Any) -> None:
    """Publish the JSON Schema of case files beside the pages."""
    text = json.dumps(schema(), indent=2)
    Path(config["site_dir"], "case.schema.json").write_text(text + "\n", encoding="utf-8")


def _bench() -> str:
    """Tables and the figure of growth, from the measurements that `study bench` wrote."""
    bench = read(Path(__file__).parent / "bench.json")
    parts = ["\n".join(f"- {sentence}" for sentence in wording.summary(bench))]
    for topic, rows in wording.topics(bench.rows):
        table = [wording.HEAD, tuple("---" for _ in wording.HEAD), *(wording.cells(row) for row in rows)]
        lines = ["| " + " | ".join(text.replace("|", "\\|") for text in cells) + " |" for cells in table]
        parts.append(f"## {topic}\n\n" + "\n".join(lines))
    colours = (
        "--ink: currentColor; --muted: #808890; --grid: #80889055; --s1: #0067a8; --s2: #c2490a; --s3: #00795a; "
        "--s4: #9a3f83; --s5: #5f6670; --s6: #7a6400"
    )
    picture = figures.growth(bench.growth, legend=True)
    parts.append(f'## Growth\n\n<div style="{colours}">{picture}</div>')
    machine = "; ".join(f"{name} {text}" for name, text in bench.environment.items())
    return "\n\n".join([*parts, f"Measured on: {machine}."])


def _rooms() -> str:
    """Folders of the two packages and what stands in each, from their docstrings."""
    root = Path(__file__).parents[1]
    lines = ["| folder | subject |", "|---|---|"]
    for package in ("study", "baselines"):
        for folder in sorted(path.parent for path in (root / package).glob("*/__init__.py")):
            text = ast.get_docstring(ast.parse((folder / "__init__.py").read_text(encoding="utf-8"))) or ""
            lines.append(f"| `{package}/{folder.name}/` | {text.partition(chr(10))[0]} |")
    return "\n".join(lines)


def _options(name: str) -> str:
    """Table of the arguments and options of a command, from the command itself."""
    command = dict(commands_with_names())[name]
    rows = ["| argument or option | meaning |", "|---|---|"]
    for param in command.params:
        if param.name != "help":
            said = " / ".join([*param.opts, *param.secondary_opts]) if param.opts[0].startswith("-") else param.metavar
            default = param.default if isinstance(param.default, int | float | str | Path) else None
            known = "" if default is None or isinstance(default, bool) else f" Default: `{default}`."
            rows.append(f"| `{said}` | {_plain(param.help or '')}{known} |")
    return "\n".join(rows) if len(rows) > 2 else ""


def _ledger() -> str:
    lines = []
    for paper, entries in groupby(ledger(), key=lambda entry: entry.paper):
        lines.append(f"\n## {paper}\n")
        for entry in entries:
            consequence = f" {entry.consequence}" if entry.consequence else ""
            lines += [
                f"**{_plain(entry.place)}** ({entry.kind}).",
                f"Printed: {_plain(entry.printed).rstrip('.')}. {_plain(entry.problem)}",
                f"Our reading: {_plain(entry.reading)}{_plain(consequence)}\n",
            ]
    return "\n".join(lines)


def _planners() -> str:
    rows = ["| name | kind | may change | how it works |", "|---|---|---|---|"]
    for name in sorted({*method_names()} - {*peer_names()}):
        method = method_named(name)
        rows.append(f"| `{name}` | {kind_of(method)} | {method.freedom} | {method.about} |")
    return "\n".join(rows)


def _fields() -> str:
    content = schema()
    rows = ["| field | meaning |", "|---|---|"]
    for name, field in content["properties"].items():
        meaning = field.get("description", "")
        if not meaning and "$ref" in str(field):
            target = next(word for word in str(field).replace("'", "/").split("/") if word in content["$defs"])
            meaning = content["$defs"][target].get("description", "")
        rows.append(f"| `{name}`{' (needed)' if name in content['required'] else ''} | {_plain(meaning)} |")
    return "\n".join(rows)


def _plain(text: str) -> str:
    return html.escape(text, quote=False).replace("|", "\\|").replace("*", "\\*").replace("\n", " ")
