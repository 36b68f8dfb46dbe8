"""The process that asks Tesseract: a question as JSON on standard input, states as JSON in the output's last line.

It imports nothing of this project, so that nothing loads another C++ runtime first.
"""

from __future__ import annotations

import importlib
import json
import sys
import tempfile
from pathlib import Path
from typing import Any

TOLERANCE = 0.001
"""Of the corners that TOTG cuts, rad or m."""


def environment(urdf: str, names: list[str]) -> Any:
    """An environment with one group of all joints."""
    common: Any = importlib.import_module("tesseract_robotics.tesseract_common")
    package: Any = importlib.import_module("tesseract_robotics.tesseract_environment")
    joints = "".join(f'<joint name="{name}"/>' for name in names)
    srdf = f'<robot name="arm" version="1.0.0"><group name="arm">{joints}</group></robot>'
    place = package.Environment()
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"arm.{ending}" for ending in ("urdf", "srdf")]
        for file, text in zip(files, (urdf, srdf), strict=True):
            file.write_text(text)
        if not place.init(*map(str, files), common.GeneralResourceLocator()):
            raise RuntimeError("the environment cannot be made")
    return place


def program(names: list[str], waypoints: list[list[float]]) -> Any:
    """The waypoints as a program."""
    common: Any = importlib.import_module("tesseract_robotics.tesseract_common")
    language: Any = importlib.import_module("tesseract_robotics.tesseract_command_language")
    numpy: Any = importlib.import_module("numpy")
    manipulator = common.ManipulatorInfo()
    manipulator.manipulator = "arm"
    moves = language.CompositeInstruction()
    moves.setManipulatorInfo(manipulator)
    for point in waypoints:
        state = language.StateWaypointPoly_wrap_StateWaypoint(language.StateWaypoint(names, numpy.array(point)))
        move = language.MoveInstruction(state, language.MoveInstructionType_FREESPACE)
        moves.appendMoveInstruction(language.MoveInstructionPoly_wrap_MoveInstruction(move))
    return moves


def states(asked: dict[str, Any]) -> list[Any]:
    """Times, positions, velocities and accelerations."""
    language: Any = importlib.import_module("tesseract_robotics.tesseract_command_language")
    timing: Any = importlib.import_module("tesseract_robotics.tesseract_time_parameterization")
    numpy: Any = importlib.import_module("numpy")
    totg = asked["method"] == "TOTG"
    profile = timing.TOTGCompositeProfile() if totg else timing.ISPCompositeProfile()
    if totg:
        profile.path_tolerance = TOLERANCE
    profile.override_limits = True
    for kind in ("velocity", "acceleration"):
        limit = numpy.array(asked[kind])
        setattr(profile, f"{kind}_limits", numpy.asfortranarray(numpy.column_stack((-limit, limit))))
    profiles, moves = language.ProfileDictionary(), program(asked["names"], asked["waypoints"])
    profiles.addProfile(asked["method"], "DEFAULT", profile)
    method = timing.TimeOptimalTrajectoryGeneration() if totg else timing.IterativeSplineParameterization()
    if not method.compute(moves, environment(asked["urdf"], asked["names"]), profiles):
        raise RuntimeError("the time parameterization failed")
    timed = timing.InstructionsTrajectory(moves)
    getters = (timed.getTimeFromStart, timed.getPosition, timed.getVelocity, timed.getAcceleration)
    return [[numpy.asarray(get(k)).tolist() for k in range(timed.size())] for get in getters]


if __name__ == "__main__":
    try:
        answer = json.dumps(states(json.load(sys.stdin)))
    except RuntimeError as error:
        sys.exit(str(error).strip().splitlines()[0])
    print(answer)
