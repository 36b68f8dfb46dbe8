"""Named configurations of MoveIt's SRDF files as waypoints.

References
----------
MoveIt, SRDF: group_state with one joint element, its name and its value, for each joint.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from study.errors import StudyError, unknown
from study.io.samples import Samples
from study.io.table import number
from study.io.xml_file import read_xml


def samples_from_srdf(path: Path) -> Samples:
    """Read group states: those named after `#` in their order, or all of them.

    Parameters
    ----------
    path : Path
        `robot.srdf`, or `robot.srdf#home,ready,home`.

    Raises
    ------
    StudyError
        If the file cannot be read, a state is unknown, or states name other joints.
    """
    file, _, chosen = path.name.partition("#")
    where = f"file {file!r}"
    states = {}
    for state in read_xml(path.with_name(file)).iter("group_state"):
        name = state.get("name", "")
        values = {joint.get("name", ""): joint.get("value", "") for joint in state.iter("joint")}
        states[name] = {joint: number(value, f"{where}, state {name!r}") for joint, value in values.items()}
    names = [name.strip() for name in chosen.split(",")] if chosen else list(states)
    for name in names:
        if name not in states:
            raise unknown(f"group state in {where}:", name, states)
    if not names:
        raise StudyError(f"{where} holds no group states")
    joints = list(states[names[0]])
    for name in names:
        if set(states[name]) != set(joints):
            raise StudyError(
                f"{where}: states {names[0]!r} and {name!r} name other joints; choose states of one group after '#'"
            )
    rows = np.array([[states[name][joint] for joint in joints] for name in names])
    return Samples(rows, tuple(joints), si=True, notes=(f"waypoints are the states {', '.join(names)}",))
