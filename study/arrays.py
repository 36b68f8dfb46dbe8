"""Numbers from outside: copied into read-only arrays, or refused with one sentence."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study.errors import StudyError

Floats = NDArray[np.float64]


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
        If the values are no rectangular table of numbers, an entry is masked or an entry is not a number.
    """
    if np.ma.is_masked(values):
        raise StudyError(f"{what} holds a masked entry; fill the array in first")
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise StudyError(f"{what} must be a rectangular table of numbers: {error}") from None
    if np.isnan(array).any():
        where = ", ".join(str(i + 1) for i in np.argwhere(np.isnan(array))[0])
        raise StudyError(f"{what} holds a value that is not a number (NaN) at position {where}; give a number there")
    array.setflags(write=False)
    return array
