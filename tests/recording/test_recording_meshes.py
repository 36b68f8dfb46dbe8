"""Arms drawn as the meshes of the user's own URDF file: found, placed, and left out with a reason where they are not there."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from rerun.chunk import RrdReader

from study.analysis.case_summary import summarise_case
from study.cases.library import Case, load_case
from study.recording import meshes, record_case, viewer
from study.recording.contents import NANOSECOND, gather
from study.recording.process import private_environment
from study.recording.stream import entity
from study.robots import robot_named
from study.robots.urdf import UrdfRobot, urdf_robot
from tests.helpers.recordings import chunks, on_curve, result
from tests.helpers.robot_files import URDF
from tests.helpers.viewer import can_draw, pixels

CASE = """\
units: [rad, m, rad]
joints: [turn, slide, spin]
robot: bench.urdf
waypoints: [[0.0, 0.1, 0.0], [1.0, 0.5, 0.8], [0.3, 0.2, -0.4], [-0.6, 0.4, 0.2]]
limits: {velocity: [1.0, 0.5, 2.0], acceleration: [3.0, 1.0, 5.0]}
"""
VISUAL = '<link name="{link}"><visual><origin xyz="0 0.1 0" rpy="0 0 1.5"/><geometry><mesh filename="{file}" scale="2 2 2"/></geometry></visual></link>'


def tetrahedron() -> bytes:
    """A mesh of four triangles as binary STL."""
    corners = 0.1 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float32)
    faces = [corners[list(face)] for face in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))]
    rows = [np.zeros(3, np.float32).tobytes() + face.tobytes() + b"\0\0" for face in faces]
    return b"\0" * 80 + np.uint32(len(rows)).tobytes() + b"".join(rows)


@pytest.fixture
def make(tmp_path: Path) -> Callable[..., tuple[Case, Path]]:
    """Write a URDF file whose links name meshes, and a case with that robot."""

    def made(**files: str) -> tuple[Case, Path]:
        text = URDF
        for link, file in files.items():
            text = text.replace(f'<link name="{link}"/>', VISUAL.format(link=link, file=file))
        folder = tmp_path / "robots" / "urdf"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "bench.urdf").write_text(text)
        (folder / "bench.yaml").write_text(CASE)
        robot_named.cache_clear()
        return load_case(str(folder / "bench.yaml")), folder

    return made


def recorded(case: Case, path: Path) -> Path:
    runs = [result(case, name, on_curve(case, np.array(d))) for name, d in (("one", [1, 1, 1]), ("two", [2, 1, 1]))]
    return record_case(summarise_case(case, runs), path, samples=30)


def summary(path: Path) -> str:
    (batch,) = chunks(path, "/summary", "TextDocument:text")
    return str(batch.column("TextDocument:text").to_pylist()[0][0])


def test_meshes_stand_where_forward_kinematics_puts_their_links(
    make: Callable[..., tuple[Case, Path]], tmp_path: Path
) -> None:
    case, folder = make(base="stand.stl", l1="package://robots/meshes/arm.stl", l3="../meshes/arm.STL", tool="arm.obj")
    (folder.parent / "meshes").mkdir()
    for place in (folder / "stand.stl", folder.parent / "meshes/arm.stl", folder.parent / "meshes/arm.STL"):
        place.write_bytes(tetrahedron())
    (folder / "arm.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    robot_named.cache_clear()
    path = recorded(case, tmp_path / "a.rrd")
    robot = robot_named(str(case.robot), tuple(case.problem.joint_names))
    assert isinstance(robot, UrdfRobot)
    assert robot.missing == ""
    assert [shape.frame for shape in robot.shapes] == [0, 1, 3, 3]
    assert "capsules" not in summary(path)
    runs = [result(case, name, on_curve(case, np.array(d))) for name, d in (("one", [1, 1, 1]), ("two", [2, 1, 1]))]
    shown = gather(summarise_case(case, runs), 30).shown
    bases = []
    for each in shown:
        (batch,) = chunks(path, entity("arms", each.label), "Transform3D:translation")
        bases.append(batch.column("Transform3D:translation").to_pylist()[0][0])
        assert chunks(path, entity("arms", each.label, "base"), "LineStrips3D:strips")
    assert np.linalg.norm(np.subtract(*bases)) == pytest.approx(meshes.APART)
    for number, shape in enumerate(robot.shapes):
        (batch,) = chunks(path, f"/meshes/{number}", "InstancePoses3D:translations")
        times = batch.column("t").cast(pa.int64()).to_numpy() * NANOSECOND
        moved = batch.column("InstancePoses3D:translations").flatten().flatten().to_numpy().reshape(-1, 2, 3)
        for arm, (each, base) in enumerate(zip(shown, bases, strict=True)):
            frames = robot.frames(each.motion(np.minimum(times, each.motion.duration)))[:, shape.frame] @ shape.place
            np.testing.assert_allclose(moved[:, arm], frames[:, :3, 3] + base, atol=1e-5)
        (batch,) = chunks(path, f"/meshes/{number}", "Asset3D:blob")
        (blob,) = batch.column("Asset3D:blob").to_pylist()[0]
        assert bytes(blob) == shape.path.read_bytes()
        np.testing.assert_array_equal(shape.scale, 2.0)
    paths = RrdReader(str(path)).store().schema().entity_paths()
    assert sum(path.startswith("/meshes/") for path in paths) == len(robot.shapes)  # once for both arms
    with private_environment() as (program, environment):
        subprocess.run([program, "rrd", "verify", str(path)], env=environment, check=True, capture_output=True)


def test_a_mesh_keeps_its_place_on_its_link(make: Callable[..., tuple[Case, Path]]) -> None:
    _, folder = make(base="stand.stl", tool="stand.stl")
    (folder / "stand.stl").write_bytes(tetrahedron())
    stand, tool = urdf_robot(folder / "bench.urdf").shapes
    np.testing.assert_allclose(stand.place @ [0, 0, 0, 1], [-0.1, 0, 0.4, 1], atol=1e-12)  # mount turns y to -x
    np.testing.assert_allclose(tool.place @ [0, 0, 0, 1], [0, 0.1, 0.1, 1], atol=1e-12)  # the flange is 0.1 along z


@pytest.mark.parametrize(
    ("file", "reason"),
    [
        ("gone.stl", "'gone.stl' is not there"),
        ("package://nobody/has/this.stl", "'package://nobody/has/this.stl' is not there"),
        ("../../../../../../../etc/passwd", "is no mesh that the viewer can show, which are .stl, .obj, .glb, .dae"),
        ("a%00b.stl", "is not there"),
        ("file:///no%00where.stl", "is not there"),
        (f"{'x' * 5000}.stl", "is not there"),
        ("", "is no mesh"),
    ],
)
def test_what_is_not_there_is_drawn_as_capsules_with_the_reason(
    make: Callable[..., tuple[Case, Path]], tmp_path: Path, file: str, reason: str
) -> None:
    case, folder = make(base="stand.stl", l1=file)
    (folder / "stand.stl").write_bytes(tetrahedron())
    robot_named.cache_clear()
    path = recorded(case, tmp_path / "a.rrd")
    text = summary(path).replace("\\", "")
    assert "Links are drawn as capsules: " in text
    assert reason in text
    assert chunks(path, entity("arms", "one", "links"), "Capsules3D:lengths")


def test_meshes_that_would_fill_the_recording_are_left_out(
    make: Callable[..., tuple[Case, Path]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case, folder = make(base="stand.stl")
    (folder / "stand.stl").write_bytes(tetrahedron())
    robot_named.cache_clear()
    monkeypatch.setattr(meshes, "ROOM", 100)
    text = summary(recorded(replace(case), tmp_path / "a.rrd"))
    assert "Links are drawn as capsules: their meshes would take" in text


@pytest.mark.parametrize("heavy", [True, False])
def test_collision_meshes_stand_in_for_those_that_are_too_large_or_cannot_be_shown(
    make: Callable[..., tuple[Case, Path]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, heavy: bool
) -> None:
    case, folder = make(l1="large.stl" if heavy else "fine.ply", tool="large.stl")
    urdf = folder / "bench.urdf"
    collision = '<collision><geometry><mesh filename="small.stl"/></geometry></collision></link>'
    urdf.write_text(urdf.read_text().replace("</visual></link>", f"</visual>{collision}"))
    (folder / "small.stl").write_bytes(tetrahedron())
    (folder / "large.stl").write_bytes(tetrahedron() + b"\0" * 1000)
    monkeypatch.setattr(meshes, "ROOM", 900)
    robot_named.cache_clear()
    path = recorded(case, tmp_path / "a.rrd")
    text = summary(path).replace("\\", "")
    assert "Links are drawn as what they are looked for collisions with: " in text
    assert ("their meshes would take" if heavy else "'fine.ply' is no mesh") in text
    (batch,) = chunks(path, "/meshes/0", "Asset3D:blob")
    assert bytes(batch.column("Asset3D:blob").to_pylist()[0][0]) == tetrahedron()


def test_collision_meshes_of_some_links_only_do_not_stand_for_an_arm(make: Callable[..., tuple[Case, Path]]) -> None:
    _, folder = make(l1="gone.stl", tool="gone.stl")
    urdf = folder / "bench.urdf"
    collision = '<collision><geometry><mesh filename="small.stl"/></geometry></collision></link>'
    urdf.write_text(urdf.read_text().replace("</visual></link>", f"</visual>{collision}", 1))
    (folder / "small.stl").write_bytes(tetrahedron())
    assert urdf_robot(urdf).plain == ()


@can_draw
@pytest.mark.timeout(120)
def test_the_viewer_draws_the_meshes_without_complaint(make: Callable[..., tuple[Case, Path]], tmp_path: Path) -> None:
    case, folder = make(base="stand.stl", l1="stand.stl", l2="stand.stl", l3="stand.stl")
    (folder / "stand.stl").write_bytes(tetrahedron())
    robot_named.cache_clear()
    path = recorded(case, tmp_path / "a.rrd")
    with viewer.headless(path, (1000, 700)) as client:
        viewer.show_tab(client, "All arms")
        client.set_time("t", duration=0.3, play_state="paused")
        picture = pixels(viewer.settled_picture(client))
        assert viewer.complaints(client) == []
        assert [one.message for one in client.get_logs() if one.level == "ERROR"] == []
    assert (np.ptp(picture.astype(int), axis=2) > 60).mean() > 5e-3
