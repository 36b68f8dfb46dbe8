"""Shared by the tests: viewer."""

from __future__ import annotations

import glob
import os
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

DRIVERS = ("/usr/share/vulkan/icd.d/*.json", "/usr/local/share/vulkan/icd.d/*.json", "/etc/vulkan/icd.d/*.json")


can_draw = pytest.mark.skipif(
    not any(glob.glob(pattern) for pattern in DRIVERS) and not os.environ.get("VK_DRIVER_FILES"),
    reason="no Vulkan driver here; Debian and Ubuntu have a software one in the package mesa-vulkan-drivers",
)


def pixels(png: bytes) -> np.ndarray:
    """Decode an 8-bit RGB or RGBA picture, shape (height, width, channels)."""
    return np.asarray(Image.open(BytesIO(png)).convert("RGB"))
