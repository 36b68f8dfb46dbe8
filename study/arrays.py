"""Numbers from outside: copied into read-only arrays, or refused with one sentence."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study.errors import StudyError, plural, short

Floats = NDArray[np.float64]
T = TypeVar("T")


def frozen_array(values: ArrayLike, what: str) -> Floats:
    """Copy numbers into a read-only float array.

    Parameters
    ----------
    values : array_like of numbers
    what : str
        Name of the values in error messages.

    Raises
    ------
    StudyError
        If the values are no rectangular table of numbers, an entry is masked or an entry is not a number; true and false
        are none.
    """
    if np.ma.is_masked(values):
        raise StudyError(f"{what} holds a masked entry; fill the array in first")
    if _holds_boolean(values):
        raise StudyError(f"{what} must be made of numbers, not of true and false")
    if getattr(getattr(values, "dtype", None), "kind", "f") in "cmM":
        raise StudyError(f"{what} must be made of real numbers, not of complex ones or dates")
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise StudyError(f"{what} must be a rectangular table of numbers: {error}") from None
    if np.isnan(array).any():
        where = ", ".join(str(i + 1) for i in np.argwhere(np.isnan(array))[0])
        place = f" at position {where}" if where else ""
        raise StudyError(f"{what} holds a value that is not a number (NaN){place}; give a number there")
    array.setflags(write=False)
    return array


def _holds_boolean(values: object) -> bool:
    if isinstance(values, np.ndarray | np.generic):
        return values.dtype == bool or (values.dtype == object and any(map(_holds_boolean, values.ravel())))
    if isinstance(values, list | tuple):
        return any(map(_holds_boolean, values))
    return isinstance(values, bool)


def positive(value: object, what: str) -> float:
    """Read one positive finite number.

    Raises
    ------
    StudyError
        If the value is anything else; true and false are no numbers.
    """
    if not 0 < (number := _number(value)) < np.inf:
        raise StudyError(f"{what} must be a positive number, got {short(value)}")
    return number


def at_least_zero(value: object, what: str) -> float:
    """Read one number that is zero, positive or infinite.

    Raises
    ------
    StudyError
        If the value is anything else; true and false are no numbers.
    """
    if not (number := _number(value)) >= 0:
        raise StudyError(f"{what} must be a number of at least 0, got {short(value)}")
    return number


def _number(value: object) -> float:
    """Take one real number; NaN for anything else."""
    try:
        return (
            float(value)
            if isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
            else np.nan
        )
    except OverflowError:  # a whole number beyond all floats
        return np.nan


def whole(value: object, least: int, what: str, most: float = np.inf) -> int:
    """Read one whole number.

    Raises
    ------
    StudyError
        If the value is anything else, too small or too large.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not least <= value <= most:
        above = "" if most == np.inf else f" and at most {most:g}"
        raise StudyError(f"{what} must be a whole number of at least {least}{above}, got {short(value)}")
    return int(value)


def of_kind(value: object, kind: type[T], what: str) -> T:
    """Refuse anything but an object of one kind.

    Raises
    ------
    StudyError
        If the value is anything else.
    """
    if not isinstance(value, kind):
        raise StudyError(f"{what} must be a {kind.__name__}, got {type(value).__name__} {short(value)}")
    return value


def row(values: ArrayLike, length: int, what: str) -> Floats:
    """Copy a row of so many numbers.

    Raises
    ------
    StudyError
        If it is anything else.
    """
    array = frozen_array(values, what)
    if array.shape != (length,):
        raise StudyError(f"{what} must be a row of {plural(length, 'number')}, got shape {array.shape}")
    return array


def index_in(index: object, allowed: range, what: str) -> int:
    """Read a place in a row, counted from 0.

    Raises
    ------
    StudyError
        If it is no integer among the allowed ones.
    """
    if isinstance(index, bool) or not isinstance(index, int | np.integer) or index not in allowed:
        places = f"from {allowed[0]} to {allowed[-1]}" if allowed else "none"
        raise StudyError(f"{what} {short(index)} is none of the places allowed, which are {places}")
    return int(index)


def check_kinds(part: object, kinds: Mapping[str, tuple[type, ...]], where: str) -> None:
    """Refuse a field that holds another kind of object than it may.

    Parameters
    ----------
    part : object
    kinds : mapping of str to tuple of type
        Name of a field: what it may hold.
    where : str
        How the message begins.

    Raises
    ------
    StudyError
        For the first field that holds anything else.
    """
    for name, allowed in kinds.items():
        value = getattr(part, name)
        if not isinstance(value, allowed):
            words = " or ".join(kind.__name__ for kind in allowed if kind is not type(None))
            raise StudyError(f"{where}: {name} must be a {words}, got {type(value).__name__} {short(value)}")
