"""LAPACK's banded solvers, as SciPy brings them.

All of `scipy.linalg` takes a tenth of a second to import, more than many a motion takes to plan. The file with LAPACK
alone is loaded where it is found; otherwise, and where `scipy.linalg` is there already, it comes from there.
"""

from __future__ import annotations

import sys
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from study.problem import Floats


def _found() -> Any:
    spec = PathFinder.find_spec("_flapack", [str(Path(scipy.__file__).with_name("linalg"))])
    if "scipy.linalg" not in sys.modules and spec is not None and spec.loader is not None:
        try:
            module = module_from_spec(spec)
            spec.loader.exec_module(module)
        except ImportError:
            pass
        else:
            return module
    from scipy.linalg import lapack

    return lapack


_LAPACK = _found()


def factor_banded(band: Floats) -> Floats:
    """Cholesky factor of a symmetric matrix in lower banded form; empty where it is not positive definite.

    Parameters
    ----------
    band : array of shape (width + 1, n)
        May be overwritten.
    """
    if not band.size:
        return band
    factor, info = _LAPACK.dpbtrf(band, lower=1, overwrite_ab=1)
    return np.empty((0, 0)) if info else np.asarray(factor)


def solve_factored(factor: Floats, right: Floats) -> Floats:
    """Solve with a factor of `factor_banded`; the right side has shape (n,)."""
    return np.asarray(_LAPACK.dpbtrs(factor, right, lower=1)[0])


def solve_tridiagonal(lower: Floats, diagonal: Floats, upper: Floats, right: Floats) -> Floats:
    """Solve a tridiagonal system of n unknowns, right side of shape (n, m); off the diagonal stand n - 1 numbers each.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is singular.
    """
    if len(diagonal) == 1:
        return np.asarray(right / diagonal)
    answer, info = _LAPACK.dgtsv(lower, diagonal, upper, right)[-2:]
    if info:
        raise np.linalg.LinAlgError("singular matrix")
    return np.asarray(answer)
