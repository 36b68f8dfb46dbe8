"""Location of the project's data, and validation of YAML files against models."""

from __future__ import annotations

from collections.abc import Iterator
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from study.errors import StudyError
from study.io.documents import parsed

try:
    import yaml  # noqa: F401
    from pydantic import BaseModel, ConfigDict, ValidationError
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(
        "cases from files and those of the papers need the Python packages pydantic and pyyaml; install them with: "
        "pip install pydantic pyyaml",
        name=error.name,
    ) from None

PACKAGE = Path(__file__).resolve().parent


class Strict(BaseModel):
    """A model that knows every key it accepts and takes only finite numbers."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)


FORMS = (
    *("one for all", "one for each", "by direction", "file name", "rows", "list"),
    *("condition", "rates", "name", "shape", "number", "kinds"),
)
"""Names of the forms that one field may take; they are no part of a field's name."""

Model = TypeVar("Model", bound=BaseModel)


@cache
def data_folder() -> Path:
    """Find the data: inside the installed package, or beside it in a checkout.

    Raises
    ------
    StudyError
        If neither place has a folder of cases.
    """
    for folder in (PACKAGE / "data", PACKAGE.parent / "data"):
        if (folder / "cases").is_dir():
            return folder
    raise StudyError(
        f"no data folder beside or inside {PACKAGE}; install the package again or work from a full checkout"
    )


def read_yaml(path: Path) -> dict[str, Any]:
    """Read one YAML file that must hold a mapping.

    Raises
    ------
    StudyError
        If the file is missing, cannot be read, is not YAML or is not a mapping.
    """
    content = parsed(path)
    if not isinstance(content, dict):
        raise StudyError(f"file {str(path)!r} must hold named fields (a YAML mapping), got {type(content).__name__}")
    return content


def checked(model: type[Model], content: object, where: str) -> Model:
    """Build a model from parsed YAML, or say in one sentence which field is wrong.

    Parameters
    ----------
    model : subclass of BaseModel
    content : object
        What the YAML file held.
    where : str
        How the message begins, such as `file 'woodworking.yaml'`.

    Raises
    ------
    StudyError
        For the first field that does not fit.
    """
    try:
        built = model.model_validate(content)
    except ValidationError as error:
        raise StudyError(_sentence(error, model, where)) from None
    for field in _booleans(content, built.model_dump(by_alias=True)):
        raise StudyError(f"{where}: field {field!r} must be a number, got true or false")
    return built


def _booleans(given: Any, taken: Any, field: str = "") -> Iterator[str]:
    """Fields whose true or false was taken for a number."""
    if isinstance(given, dict) and isinstance(taken, dict):
        if any(isinstance(key, bool) for key in given):
            yield field
        for key in given.keys() & taken.keys():
            yield from _booleans(given[key], taken[key], f"{field}.{key}".lstrip("."))
    elif isinstance(given, list) and isinstance(taken, list | tuple):
        if not all(type(value) is float for value in given):  # as a long row of numbers is
            for value, number in zip(given, taken, strict=False):
                yield from _booleans(value, number, field)
    elif isinstance(given, bool) and not isinstance(taken, bool):
        yield field


def _sentence(error: ValidationError, model: type[BaseModel], where: str) -> str:
    mistakes = error.errors(include_url=False)
    first, *others = sorted(
        mistakes, key=lambda mistake: mistake["type"] != "extra_forbidden"
    )  # what is misspelt is missing too
    field = ".".join(part for part in first["loc"] if isinstance(part, str) and part not in FORMS) or "the file"
    places = " of ".join(f"item {part + 1}" for part in reversed(first["loc"]) if isinstance(part, int))
    more = f" (and {len(others)} more)" if others else ""
    if first["type"] == "extra_forbidden":
        key, keys = str(first["loc"][-1]), _keys(model)
        cut = [name for name in keys if len(key) > 2 and name.startswith(key)]
        near = cut or get_close_matches(key, keys, n=1, cutoff=0.5)
        hint = f"did you mean {near[0]!r}?" if near else "remove it or correct its spelling"
        return f"{where}: unknown key {field!r}; {hint}{more}"
    if first["type"] == "missing":
        return f"{where}: field {field!r} is missing; add it{more}"
    message = first["msg"].removeprefix("Value error, ")
    came = "" if first["type"] == "value_error" else f", got {str(first['input'])[:60]!r}"
    came = ", got nothing" if first["input"] is None else came
    field = repr(field) + (f", {places}" if places else "")
    return f"{where}: field {field}: {message[:1].lower()}{message[1:]}{came}{more}"


@cache
def _keys(model: type[BaseModel]) -> list[str]:
    """Names of all fields of a model and of the models in it."""
    schema = model.model_json_schema()
    parts = [schema, *schema.get("$defs", {}).values()]
    return sorted({name for part in parts for name in part.get("properties", {})})
