"""Every reader with valid files to begin with, called as the commands call it."""

from __future__ import annotations

import io
import json
import os
import tempfile
from collections.abc import Callable, Mapping
from contextlib import ExitStack, redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

import numpy as np
import typer
import yaml

from study.cases.library import Case
from study.cli.check import check
from study.cli.example import EXAMPLE
from study.cli.screen import clean
from study.errors import StudyError
from study.io.exact import FORMAT, exact_text
from study.io.export import write_motion
from study.io.sampling import Sampling
from study.planning import RunSettings
from study.registry import planner_named
from study.robots import robot_named
from study.runs.execute import cell_jobs, stored_results
from study.runs.lineup import Budget, make_cells, parse_specs
from study.runs.remembered import remember_lineup, remembered_lineup
from study.runs.runner import run_jobs
from study.store.maintenance import compact, export_columns, merge, tallies, verify
from study.store.store import Store
from study.trajectory import Motion
from tests.conftest import CASE_FILE, case_of
from tests.helpers.robot_files import MOVEIT, URDF
from tests.helpers.stores import TINY

JOINTS = ("elbow", "wrist")
LIMITS = """\
joint_limits:
  elbow: {has_velocity_limits: true, max_velocity: 1.0, has_acceleration_limits: true, max_acceleration: 2.0}
  wrist: {has_velocity_limits: true, max_velocity: 0.8, has_acceleration_limits: true, max_acceleration: 1.5, max_jerk: 20}
"""
FRANKA = """\
elbow: {limit: {lower: -2.9, upper: 2.9, velocity: 1.0, acceleration: 2.0, effort: 87.0}}
wrist: {limit: {lower: -2.9, upper: 2.9, velocity: 0.8, acceleration: 1.5, jerk: 20.0}}
"""
CASE = """\
version: 1
units: [rad, deg]
joints: [elbow, wrist]
waypoints: [[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [0.9, 0.3], [1.4, 0.1]]
limits:
  velocity: {lower: [-1, -2], upper: [1.0, null]}
  acceleration: 2.0
  jerk: [30, 40]
  position: {lower: -7, upper: [7, null]}
start: {velocity: [0.1, 0]}
finish: rest
stops: [2]
dwells: {3: 0.5}
segments: [{from: 1, to: 2, velocity: 0.5}]
tolerance: [0, 0.1, 0.1, 0.1, 0]
path: {tube: 0.1}
duration: {at_least: 3}
cycle: 0.004
speed: 0.5
robot: arm.yaml
obstacles: [{lower: [0.3, -0.2, 0.0], upper: [0.5, 0.2, 0.4]}]
duration_bounds: {lower: 0.1, upper: 9}
curve: cubic-spline
notes: [a note]
"""
ARM = """\
title: two links
source: made up
convention: standard
length_unit: m
joints:
  - {kind: revolute, a: 0.4, alpha: 0, d: 0.1, theta: 0}
  - {kind: prismatic, a: 0.3, alpha: 1.5, d: 0, theta: 0, range: [-3, 3]}
"""
TRAJECTORY = """\
joint_names: [elbow, wrist]
points:
- {positions: [0.0, 0.2], velocities: [0, 0], accelerations: [0, 0], time_from_start: {sec: 0, nanosec: 0}}
- {positions: [0.5, -0.1], velocities: [0.1, 0], accelerations: [0, 0], time_from_start: {sec: 1, nanosec: 500000000}}
- {positions: [1.4, 0.1], velocities: [0, 0], accelerations: [0, 0], time_from_start: {secs: 3, nsecs: 0}, effort: [1]}
"""
DISPLAYED = """\
model_id: arm
trajectory:
- joint_trajectory: {joint_names: [elbow, wrist], points: [{positions: [0, 0]}, {positions: [1, 1], time_from_start: 1}]}
- joint_trajectory: {joint_names: [wrist, elbow], points: [{positions: [1, 1]}, {positions: [2, 0], time_from_start: 2.5}]}
"""
STATES = """\
header: {stamp: {sec: 1, nanosec: 5}}
name: [elbow, wrist]
position: [0.0, 0.2]
velocity: [0.0, 0.0]
---
header: {stamp: {sec: 2, nanosec: 5}}
name: [wrist, elbow]
position: [0.5, 0.2]
velocity: [0.0, 0.0]
effort: []
"""
SRDF = """\
<?xml version="1.0"?><robot name="arm"><group name="a"><joint name="elbow"/></group>
<group_state name="home" group="a"><joint name="elbow" value="0"/><joint name="wrist" value="0.5"/></group_state>
<group_state name="up" group="a"><joint name="elbow" value="1"/><joint name="wrist" value="1e-1"/></group_state></robot>
"""
XACRO = """\
<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="arm"><xacro:property name="v" value="${2 * 0.5}"/>
<xacro:macro name="j" params="n"><joint name="${n}" type="revolute"><parent link="a"/><child link="${n}l"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" velocity="${v}" effort="1"/><mimic joint="elbow" multiplier="2"/></joint></xacro:macro>
<joint name="elbow" type="revolute"><parent link="w"/><child link="a"/><limit lower="-3" upper="3" velocity="1" effort="1"/>
<safety_controller soft_lower_limit="-2" soft_upper_limit="2"/></joint><xacro:j n="wrist"/></robot>
"""
CSV = "elbow,wrist\n0.0,0.2\n0.5,-0.1\n0.9,0.3\n1.4,0.1\n"
GERMAN = '# "elbow";wrist\n0,0;0,2\n\n# so\n0,5;-0,1\n1,4;0,1\n'
TABS = "time\telbow_pos\twrist_pos\telbow_vel\twrist_vel\n0\t0\t0\t0\t0\n1\t1\t.5\t0\t0\n2\t1.4\t1\t0\t0\n"
ROSTOPIC = (
    "%time,field.name0,field.name1,field.position0,field.position1\n1,elbow,wrist,0.0,0.5\n2,elbow,wrist,0.5,1.5\n"
)
RTDE = "timestamp actual_q_0 actual_q_1 actual_qd_0 actual_qd_1\n0.1 0.0 0.2 0 0\n0.2 0.1 0.2 0 0\n0.3 0.2 0.3 0 0\n"


@dataclass(frozen=True)
class Target:
    """A reader.

    Attributes
    ----------
    seeds : mapping of str to bytes
        Names and contents of valid files.
    read : callable (path)
        Reads a file as a command does; may raise `StudyError` and nothing else.
    beside : mapping of str to bytes
        Files that stand in the same folder.
    """

    seeds: Mapping[str, bytes]
    read: Callable[[Path], object]
    beside: Mapping[str, bytes]

    def __call__(self, folder: Path, name: str, content: bytes) -> str:
        """Read a mutated file; the sentence with which it was refused, or nothing.

        Raises
        ------
        AssertionError
            If the sentence is none, or what was printed steers a terminal.
        """
        path = folder / name
        for other, whole in self.beside.items():
            if other in self.seeds:
                (folder / other).write_bytes(whole)
        path.write_bytes(content)
        robot_named.cache_clear()
        screen = io.StringIO()
        sentence = self._refusal(path, screen)
        assert "\n" not in sentence, f"not one line: {sentence[:200]!r}"
        shown = clean(sentence) + screen.getvalue()
        assert not {"\x1b", "\x07", "\r", "\u202e"} & set(shown), "what is printed steers the terminal"
        return sentence

    def _refusal(self, path: Path, screen: io.StringIO) -> str:
        try:
            with redirect_stdout(screen), redirect_stderr(screen), suppress(typer.Exit):
                self.read(path)
        except StudyError as error:
            return str(error) or "(nothing)\n"
        return ""


def checking(**given: object) -> Callable[[Path], None]:
    """Make `study check FILE` with the options given; files are named relative to the file's folder."""

    def read(path: Path) -> None:
        files = {
            name: path.with_name(value)
            for name, value in given.items()
            if name in ("case", "limits") and isinstance(value, str)
        }
        case, limits = files.get("case"), files.get("limits")
        units = "rad" if given else None
        check(path, case=None if case is None else str(case), units=units, limits=None if limits is None else [limits])

    return read


def as_limits(path: Path) -> None:
    """Make `study check waypoints.csv --units rad --limits FILE`."""
    check(path.with_name("w.csv"), units="rad", limits=[path])


def as_robot(path: Path) -> None:
    """Read limits of a robot's file, and its arm and meshes through a case that names it."""
    with suppress(StudyError):
        as_limits(path)
    case = path.with_name("robot.yaml")
    case.write_text(CASE.replace("arm.yaml", path.name).replace("obstacles", "self_collision: true\nobstacles"))
    check(case)


def as_bag(path: Path) -> None:
    """Make `study check BAG --units rad --limits limits.yaml` of a folder."""
    check(path.parent if path.name == "metadata.yaml" else path, units="rad", limits=[path.with_name("l.yaml")])


def as_store(path: Path) -> None:
    """Read a results file in every way that a command does."""
    content, refused = path.read_bytes(), []
    uses: tuple[Callable[[], object], ...] = (
        lambda: verify(path),
        lambda: tallies(path),
        lambda: export_columns(path, path.with_name("e.csv")),
        lambda: export_columns(path, path.with_name("e.parquet")),
        lambda: merge(path.with_name("m.sqlite"), path),
        lambda: _reported(path),
        lambda: compact(path),
        lambda: _reported(path),
    )
    for use in uses:
        try:
            use()
        except StudyError as error:
            refused.append(error)
        for part in path.parent.glob("*.part"):
            raise AssertionError(f"{part.name} is left")
        for rest in ("m.sqlite", "m.sqlite-wal", "m.sqlite-shm", "r.sqlite-wal", "r.sqlite-shm"):
            path.with_name(rest).unlink(missing_ok=True)
    path.write_bytes(content)
    if refused:
        raise refused[0]


def _reported(path: Path) -> None:
    from study.analysis.case_summary import summarise

    cells, _ = remembered_lineup(path)
    cases = {case.name: case for case in (tiny(),)}
    with Store(path, write=False) as store:
        store.digest()
        summarise(cases, stored_results(store, [cell for cell in cells if cell.case in cases], cases))


@cache
def tiny() -> Case:
    """The small case of the tests."""
    return case_of(TINY)


@cache
def motion() -> Motion:
    """A motion that solves the small case."""
    planned = planner_named("casadi-nlp").plan(TINY, RunSettings("poly353", time_limit=20.0)).motion
    assert planned is not None
    return planned


def _written(names: tuple[str, ...]) -> dict[str, bytes]:
    """The motion in the formats that the names ask for."""
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            write_motion(motion(), TINY, Path(folder) / name, Sampling(None, 12))
        return {name: (Path(folder) / name).read_bytes() for name in names}


def _arrays() -> dict[str, bytes]:
    rows = np.array([[0.0, 0.2], [0.5, -0.1], [1.4, 0.1]])
    plain, several = io.BytesIO(), io.BytesIO()
    np.save(plain, rows)
    np.savez_compressed(several, q=rows, t=np.arange(3.0), qd=0 * rows, joint_names=np.array(JOINTS), left=np.zeros(2))
    return {"a.npy": plain.getvalue(), "b.npz": several.getvalue()}


def _parquet() -> dict[str, bytes]:
    import pyarrow as pa
    import pyarrow.parquet as pq

    tables = {
        "a.parquet": {
            "time": [0.0, 1.0, 2.0],
            "elbow": [0.0, 0.5, 1.4],
            "wrist": [0.2, -0.1, 0.1],
            "text": ["a", "b", "c"],
        },
        "b.parquet": {"observation.state": [[0.0, 0.2], [0.5, -0.1]], "timestamp": [0.0, 1.0], "episode_index": [0, 0]},
    }
    files = {}
    for name, columns in tables.items():
        buffer = io.BytesIO()
        pq.write_table(pa.table(columns), buffer, compression="none", use_dictionary=name == "a.parquet")
        files[name] = buffer.getvalue()
    return files


def _bags(version: int) -> dict[str, bytes]:
    """Three joint states as a bag of ROS 1, or as two of ROS 2 with the files that describe them."""
    try:
        from rosbags.rosbag1 import Writer as One
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_typestore
    except ModuleNotFoundError:
        return {}
    types = get_typestore(Stores.ROS1_NOETIC if version == 1 else Stores.ROS2_HUMBLE)
    kind, made = "sensor_msgs/msg/JointState", types.types
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / ("a.bag" if version == 1 else "a")
        with One(place) if version == 1 else Writer(place, version=9, storage_plugin=StoragePlugin.MCAP) as bag:
            connection = bag.add_connection("/joints", kind, typestore=types)
            for k in range(3):
                seq = {"seq": k} if version == 1 else {}
                stamp = made["builtin_interfaces/msg/Time"](sec=k, nanosec=0)
                header = made["std_msgs/msg/Header"](stamp=stamp, frame_id="", **seq)
                message = made[kind](header, list(JOINTS), np.array([0.1 * k, 0.2]), np.zeros(2), np.zeros(0))
                raw = types.serialize_ros1(message, kind) if version == 1 else types.serialize_cdr(message, kind)
                bag.write(connection, k, bytes(raw))
        return {file.name: file.read_bytes() for file in ([place] if version == 1 else place.iterdir())}


def _store() -> dict[str, bytes]:
    cells = make_cells([tiny()], parse_specs("centre,random-search,toppra"), Budget(2, 50))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.sqlite"
        with Store(path) as store:
            run_jobs(cell_jobs(cells, {"tiny": tiny()}), store, workers=1)
            remember_lineup(store, cells, {"tiny": "tiny"})
        compact(path)
        return {"r.sqlite": path.read_bytes()}


def _exact() -> dict[str, bytes]:
    files = {"m.exact.json": exact_text(motion(), TINY).encode()}
    straight = [[a.tolist(), (b - a).tolist()] for a, b in pairwise(TINY.waypoints)]
    form = {"format": FORMAT, "kind": "parametric", "time": [[k, 1.0] for k in range(3)], "position": straight}
    return files | _written(("m.npz",)) | {"p.exact.json": json.dumps(form).encode()}


TINY_CASE = """\
units: rad
joints: [joint 1, joint 2]
waypoints: [[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]]
limits: {velocity: [1.0, 0.8], acceleration: [2.0, 1.5]}
end: smooth
"""
BESIDE = {"w.csv": CSV, "l.yaml": LIMITS, "c.yaml": TINY_CASE, "arm.yaml": ARM}


def _case_seeds() -> dict[str, bytes]:
    texts = {"a.yaml": CASE, "b.yaml": EXAMPLE, "c0.yaml": TINY_CASE, "paper.yaml": CASE_FILE}
    texts |= {"a.json": json.dumps(yaml.safe_load(CASE)), "tiny.json": json.dumps(yaml.safe_load(TINY_CASE))}
    return {name: text.encode() for name, text in texts.items()}


def _texts(**texts: str) -> Callable[[], dict[str, bytes]]:
    return lambda: {name.replace("_", "."): text.encode() for name, text in texts.items()}


READERS: dict[str, tuple[Callable[[], dict[str, bytes]], Callable[[Path], object]]] = {
    "case": (_case_seeds, checking()),
    "arm": (_texts(arm_yaml=ARM), lambda path: checking()(_named(path, "case.yaml", CASE))),
    "csv": (_texts(a_csv=CSV, b_csv=GERMAN, c_csv=TABS, d_csv=ROSTOPIC, e_csv=RTDE), checking(limits="l.yaml")),
    "trajectory": (
        _texts(a_yaml=TRAJECTORY, b_yaml=DISPLAYED, c_yaml=STATES, d_yaml="[[0, 1], [1, 0]]"),
        checking(limits="l.yaml"),
    ),
    "limits": (
        _texts(
            a_yaml=LIMITS, b_yaml=FRANKA, c_yaml=MOVEIT.replace("panda_joint1", "elbow").replace('"joint <2>"', "wrist")
        ),
        as_limits,
    ),
    "urdf": (
        _texts(
            a_urdf=URDF.replace('"turn"', '"elbow"').replace('"spin"', '"wrist"'),
            **({"b_urdf": XACRO, "c_xacro": XACRO} if find_spec("xacro") else {}),
        ),
        as_robot,
    ),
    "srdf": (_texts(a_srdf=SRDF), checking(limits="l.yaml")),
    "sampled": (lambda: _written(("m.csv", "m.yaml", "m.json", "s.npz")), checking(case="c.yaml")),
    "exact": (_exact, checking(case="c.yaml")),
    "arrays": (_arrays, checking(limits="l.yaml")),
    "parquet": (_parquet, checking(limits="l.yaml")),
    "bag": (lambda: _bags(1), checking(limits="l.yaml")),
    "bag2": (lambda: _bags(2), as_bag),
    "store": (_store, as_store),
}


def _named(path: Path, name: str, text: str) -> Path:
    path.with_name(name).write_text(text)
    return path.with_name(name)


@cache
def target(name: str) -> Target:
    """The reader of a name with its valid files, made once."""
    seeds, read = READERS[name][0](), READERS[name][1]
    beside = {file: text.encode() for file, text in BESIDE.items() if name != "arm"}
    return Target(seeds, read, beside | (seeds if name == "bag2" else {}))


def prepared(chosen: Target, stack: ExitStack) -> Path:
    """A folder with the files that stand beside what is read; gone when the stack ends."""
    memory = Path("/dev/shm")
    folder = Path(stack.enter_context(tempfile.TemporaryDirectory(dir=memory if os.access(memory, os.W_OK) else None)))
    for name, content in chosen.beside.items():
        (folder / name).write_bytes(content)
    return folder
