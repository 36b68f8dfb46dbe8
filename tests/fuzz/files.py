"""Strategy that draws spoilt files: the edits that suit a file by the ending of its name."""

from __future__ import annotations

from collections.abc import Mapping

from hypothesis import strategies as st

from tests.fuzz.mutations import ARRAYS, BYTES, TEXT, TREES
from tests.fuzz.stores import STORES

EDITS = {
    **dict.fromkeys((".yaml", ".json"), TREES),
    **dict.fromkeys((".csv", ".urdf", ".srdf", ".xacro"), TEXT),
    **dict.fromkeys((".npy", ".npz"), ARRAYS),
    ".sqlite": STORES,
}


@st.composite
def spoilt(draw: st.DrawFn, seeds: Mapping[str, bytes]) -> tuple[str, bytes]:
    """Draw the name and the content of a file: one of the seeds after one to four edits, most often one."""
    name = draw(st.sampled_from(sorted(seeds)))
    content, edits = seeds[name], EDITS.get(name[name.rindex(".") :], BYTES)
    for _ in range(draw(st.sampled_from([1, 1, 1, 2, 4]))):
        content = draw(st.sampled_from(edits))(content, lambda below: draw(st.integers(0, below - 1)))
    return name, content
