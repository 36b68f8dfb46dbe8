"""Plain words in the sources: docstrings that name the thing, variables that are nouns."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
QUESTION = re.compile(r"(What|Which|How|Where|Who|Whom|When|Whether)\b")
PRONOUNS = {"one", "found"}
FILES = [path.relative_to(ROOT).as_posix() for room in ("study", "baselines") for path in (ROOT / room).rglob("*.py")]
SOURCES = sorted(FILES)


def _answers_yes_or_no(node: ast.AST) -> bool:
    returns = node.returns if isinstance(node, ast.FunctionDef) else None
    return returns is not None and "bool" in ast.unparse(returns)


def _texts(node: ast.AST) -> Iterator[str]:
    """Docstrings of a module, class or function and of the constants in it."""
    for part in getattr(node, "body", ()) if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) else ():
        if isinstance(part, ast.Expr) and isinstance(part.value, ast.Constant) and isinstance(part.value.value, str):
            yield part.value.value


def _questions(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        for text in _texts(node):
            opening = QUESTION.match(text)
            if opening and not (opening[1] == "Whether" and _answers_yes_or_no(node)):
                yield text.partition("\n")[0]


def _pronouns(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.arg) and node.arg in PRONOUNS:
            yield f"{node.arg}, line {node.lineno}"
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and node.id in PRONOUNS:
            yield f"{node.id}, line {node.lineno}"


@pytest.mark.parametrize("file", SOURCES)
def test_docstrings_name_the_thing_and_variables_are_nouns(file: str):
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    assert [*_questions(tree), *_pronouns(tree)] == []


def test_lines_of_the_baselines_fit_in_120_characters():
    files = [ROOT / file for file in SOURCES if file.startswith("baselines/")]
    lines = [line for file in files for line in file.read_text(encoding="utf-8").splitlines()]
    assert [line for line in lines if len(line) > 120] == []


@pytest.mark.parametrize(
    ("source", "complaints"),
    [
        ('"""Where a file lies."""', ["Where a file lies."]),
        ('LIMIT = 1\n"""How far a joint turns."""', ["How far a joint turns."]),
        ('def moves() -> bool:\n    """Whether a joint moves."""', []),
        ('def moves() -> int:\n    """Whether a joint moves."""', ["Whether a joint moves."]),
        ("def plan(one): found = one", ["one, line 1", "found, line 1"]),
        ("durations = [one for one in rows]", ["one, line 1"]),
        ('"""Whereabouts of a file."""\nnumber = 1', []),
    ],
)
def test_a_question_or_a_pronoun_is_noticed(source: str, complaints: list[str]):
    tree = ast.parse(source)
    assert sorted([*_questions(tree), *_pronouns(tree)]) == sorted(complaints)
