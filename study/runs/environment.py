"""Environment of a study: versions and machine, as the report prints them."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version

from study.engine import described

PACKAGES = ("time-optimal-study", "numpy", "scipy", "casadi", "toppra", "ruckig", "rerun-sdk", "numba")


def environment() -> dict[str, str]:
    """Name the versions of Python, the packages that compute and the machine."""
    facts = {"Python": platform.python_version()}
    facts |= {name: _version(name) for name in PACKAGES}
    facts["curves evaluated with"] = described()
    facts["system"] = f"{platform.system()} {platform.machine()}"
    facts["processor"] = f"{_processor()}, {os.cpu_count()} logical"
    return facts


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            names = [line.partition(":")[2].strip() for line in file if line.startswith("model name")]
    except OSError:
        names = []
    return names[0] if names else platform.processor() or "unknown processor"
