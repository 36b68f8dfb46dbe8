"""The papers' cases: what they hold, where it comes from, and what a broken file says."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml

from study.cases.library import case_names, load_case
from study.cases.published import papers, tables
from study.curves import curve_named
from study.datafiles import data_folder, read_yaml
from study.errors import StudyError
from study.judge import judge
from study.problem import EndCondition
from study.robots import robot_named, robot_names
from study.robots.helix import helix_configurations

DEFAULTS = ["aubo-i5", "puma560", "ur5-bspline", "ur5-helix", "woodworking"]
MATCHED = {
    "aubo-i5": "dynamic adaptive PSO",
    "puma560": "RRT-SPSO",
    "ur5-bspline": "SMWOA",
    "ur5-helix": "TADF-SSA",
    "woodworking": "GoldS-PSO",
}
"""The paper's own result whose jerk the variant `-jerk-matched` takes as its limit."""

VARIANTS = {
    "aubo-i5-condition-2",
    "aubo-i5-condition-2-radians",
    "aubo-i5-datasheet",
    "aubo-i5-radians",
    "puma560-datasheet",
    "puma560-toolbox",
    "puma560-torque",
    "ur5-bspline-rest",
    "ur5-bspline-torque",
    "ur5-helix-smooth",
    "woodworking-c668",
    "woodworking-d489",
    *(f"{name}-jerk-matched" for name in MATCHED),
}


def test_the_five_papers_and_their_variants_are_there() -> None:
    assert case_names(default_only=True) == DEFAULTS
    assert set(DEFAULTS) | VARIANTS == set(case_names())
    assert {name for name in case_names() if load_case(name).variant_of} == VARIANTS
    assert {load_case(name).variant_of for name in VARIANTS} <= set(DEFAULTS)


@pytest.mark.parametrize("name", case_names())
def test_every_case_is_whole(name: str) -> None:
    case = load_case(name)
    assert case.name == case.problem.name == name
    assert case.paper in papers()
    assert set(case.units) <= {"rad", "m"}
    assert len(case.units) == case.problem.n_joints
    assert curve_named(case.settings.curve).name == case.curve
    assert case.robot in robot_names()
    assert case.robot_configuration(case.problem.waypoints).shape[1] == robot_named(case.robot).n_joints
    assert {"waypoints", "velocity limits", "duration bounds", "settings"} <= case.sources.keys()
    assert all(text.strip() for text in case.sources.values())
    assert all(p.source for p in case.published)


@pytest.mark.parametrize("name", case_names())
def test_the_lower_bound_excludes_no_synchronised_motion(name: str) -> None:
    problem = load_case(name).problem
    at_full_speed = (np.abs(np.diff(problem.waypoints, axis=0)) / problem.limits.velocity).max(axis=1)
    if load_case(name).paper != "woodworking-golds-pso":  # there the paper's own range is binding
        assert problem.duration_bounds[0] <= at_full_speed.min()


@pytest.mark.parametrize(
    ("name", "evaluations", "population", "synchronisation", "bounds", "end"),
    [
        ("woodworking", 15000, 50, "per-joint", (1.0, 5.0), EndCondition.SMOOTH),
        ("aubo-i5", 1000, 20, "per-joint", (0.1, 2.0), EndCondition.SMOOTH),
        ("ur5-bspline", 10000, 100, "shared", (1.0, 10.0), EndCondition.FREE),
        ("ur5-helix", 8000, 100, "shared", (0.02, 3.0), EndCondition.REST),
        ("puma560", 3000, 30, "per-joint", (0.1, 2.0), EndCondition.SMOOTH),
    ],
)
def test_settings(name, evaluations, population, synchronisation, bounds, end) -> None:
    case = load_case(name)
    assert (case.settings.evaluations, case.settings.population) == (evaluations, population)
    assert case.settings.synchronisation == synchronisation
    assert case.problem.duration_bounds == bounds
    assert case.problem.end is end


def _columns(table: str, paper: str, rows: list[str], columns: list[str]) -> np.ndarray:
    printed = tables(paper)[table]
    return np.array([[printed.value(row, column) for column in columns] for row in rows])


def test_waypoints_and_limits_repeat_the_printed_tables() -> None:
    """The tables were typed in twice, for the case and cell by cell; both must agree."""
    joints = [f"joint {j}" for j in range(1, 7)]
    wood = _columns("Table 4", "woodworking-golds-pso", joints[:4], ["A", "B", "C", "D"]).T
    np.testing.assert_array_equal(load_case("woodworking").problem.waypoints, wood)
    puma = _columns("Table 4", "puma560-chaotic-spso", [f"path point {i}" for i in range(1, 5)], joints)
    np.testing.assert_array_equal(load_case("puma560").problem.waypoints, puma)
    thetas = [f"theta{j}" for j in range(1, 7)]
    bspline = load_case("ur5-bspline").problem
    nodes = _columns("Table 4", "ur5-smwoa", [f"node {i}" for i in range(1, 7)], thetas)
    limits = _columns("Table 5", "ur5-smwoa", ["velocity (deg/s)", "acceleration (deg/s^2)"], thetas)
    np.testing.assert_allclose(bspline.waypoints, np.radians(nodes), rtol=1e-15)
    np.testing.assert_allclose(bspline.limits.rates[:2], np.radians(limits), rtol=1e-15)
    rows = ["velocity (rad/s)", "acceleration (rad/s^2)", "jerk (rad/s^3)"]
    helix = _columns("Table 4", "ur5-tadf-ssa", rows, joints[:5])
    np.testing.assert_array_equal(load_case("ur5-helix").problem.limits.rates, helix)


@pytest.mark.parametrize(("suffix", "points"), [("", ["K1", "K2", "W1"]), ("-condition-2", ["L1", "L2", "W2"])])
@pytest.mark.parametrize(("column", "unit"), [("", "deg"), ("-radians", "rad")])
def test_aubo_waypoints_repeat_both_columns_of_table_4(suffix, points, column, unit) -> None:
    names = [f"theta{j} ({unit})" for j in range(1, 7)]
    printed = _columns("Table 4", "aubo-dynamic-adaptive-pso", ["initial point", *points], names)
    printed = np.radians(printed) if unit == "deg" else printed
    np.testing.assert_allclose(load_case(f"aubo-i5{suffix}{column}").problem.waypoints, printed, rtol=1e-15)


def test_the_helix_table_is_what_the_robot_gives() -> None:
    rebuilt = helix_configurations(robot_named("ur5e-ssa"))
    case = load_case("ur5-helix")
    np.testing.assert_allclose(case.problem.waypoints, rebuilt[:, :5], atol=1e-11)
    np.testing.assert_allclose(case.robot_configuration(case.problem.waypoints), rebuilt, atol=1e-11)


def test_variants_change_one_thing() -> None:
    base = load_case("woodworking")
    for name, place, value in (("woodworking-d489", (3, 0), 0.489), ("woodworking-c668", (2, 0), 0.668)):
        variant = load_case(name)
        changed = np.argwhere(variant.problem.waypoints != base.problem.waypoints)
        assert [tuple(place_) for place_ in changed] == [place]
        assert variant.problem.waypoints[place] == value
        assert not variant.default
        assert variant.notes[0].startswith("Variant of 'woodworking'")
    assert load_case("ur5-helix-smooth").problem.end is EndCondition.SMOOTH
    rest = load_case("ur5-bspline-rest")
    assert (rest.problem.end, rest.curve) == (EndCondition.REST, "cubic-spline")
    np.testing.assert_array_equal(rest.problem.waypoints, load_case("ur5-bspline").problem.waypoints)


@pytest.mark.parametrize(("name", "label"), MATCHED.items())
def test_matched_jerk_limits_are_the_peaks_of_the_papers_own_motion(name: str, label: str) -> None:
    base, matched = load_case(name), load_case(f"{name}-jerk-matched")
    (printed,) = [
        one for one in base.published if one.label == label and one.joint is None and one.durations is not None
    ]
    motion = curve_named(base.curve).motion(base.problem.waypoints, printed.durations)
    peaks = judge(base.problem, motion).peaks[2]
    moves = np.ptp(base.problem.waypoints, axis=0) > 0
    assert peaks[moves] == pytest.approx(matched.problem.limits.jerk[moves], abs=1e-6)
    assert (peaks <= matched.problem.limits.jerk).all()
    np.testing.assert_array_equal(matched.problem.limits.rates[:2], base.problem.limits.rates[:2])
    assert judge(matched.problem, motion).feasible
    assert matched.limits_label == "jerk-matched"
    assert matched.sources["jerk limits"].startswith("ours: Peak jerk")


@pytest.mark.parametrize(
    ("name", "acceleration", "jerk"),
    [
        ("aubo-i5", [30] * 3 + [25] * 3, [300] * 3 + [250] * 3),
        ("puma560", [45, 40, 75, 70, 90, 80], [60, 60, 55, 70, 75, 70]),
    ],
)
def test_datasheet_limits_leave_velocity_alone(name: str, acceleration: list[float], jerk: list[float]) -> None:
    base, sheet = load_case(name).problem.limits, load_case(f"{name}-datasheet").problem.limits
    unit = np.pi / 180 if name == "puma560" else 1.0
    np.testing.assert_array_equal(sheet.velocity, base.velocity)
    assert sheet.acceleration == pytest.approx(np.array(acceleration) * unit)
    assert sheet.jerk == pytest.approx(np.array(jerk) * unit)


@pytest.mark.parametrize("joint", range(5))
def test_the_classic_limits_of_puma560_stand_in_the_helix_paper_too(joint: int) -> None:
    classic, printed = load_case("puma560-datasheet").problem.limits, load_case("ur5-helix").problem.limits
    assert classic.acceleration[joint] == pytest.approx(printed.acceleration[joint], abs=1e-4)
    assert classic.jerk[joint] == pytest.approx(printed.jerk[joint], abs=1e-4)


@pytest.mark.parametrize(
    ("name", "label", "worst"),
    [
        ("woodworking", "GoldS-PSO", 0.9879),
        ("aubo-i5", "dynamic adaptive PSO", 0.9744),
        ("aubo-i5-condition-2", "dynamic adaptive PSO", 1.0043),
        ("ur5-bspline", "SMWOA", 0.6729),
        ("ur5-helix", "TADF-SSA", 0.9905),
        ("puma560", "RRT-SPSO", 0.9943),
    ],
)
def test_published_durations_can_be_judged(name: str, label: str, worst: float) -> None:
    """Shares of the limits as computed here once; the ledger quotes them."""
    case = load_case(name)
    (printed,) = [p for p in case.published if p.label == label and p.joint is None]
    motion = curve_named(case.curve).motion(case.problem.waypoints, printed.durations)
    verdict = judge(case.problem, motion)
    assert verdict.duration == pytest.approx(printed.total, abs=1e-9)
    assert verdict.worst_ratio == pytest.approx(worst, abs=5e-5)
    assert verdict.feasible == (worst < 1)


def test_only_one_digit_of_joint_1_makes_the_printed_rows_feasible() -> None:
    def worst(name: str) -> list[float]:
        case = load_case(name)
        rows = [p for p in case.published if p.joint == 0]
        problem = case.problem.joint(0)
        curve = curve_named(case.curve)
        return [judge(problem, curve.motion(problem.waypoints, row.durations)).worst_ratio for row in rows]

    assert worst("woodworking") == pytest.approx([1.0340, 1.0403, 1.0711], abs=5e-5)
    assert worst("woodworking-d489") == pytest.approx([0.9946, 0.9998, 0.9986], abs=5e-5)
    assert worst("woodworking-c668") == pytest.approx([0.9967, 0.9984, 0.9969], abs=5e-5)


def test_robot_configuration_places_fixed_joints() -> None:
    case = load_case("ur5-helix")
    whole = case.robot_configuration([[1, 2, 3, 4, 5]])
    np.testing.assert_array_equal(whole, [[1, 2, 3, 4, 5, np.pi]])
    with pytest.raises(StudyError, match="shape"):
        case.robot_configuration([[1, 2, 3]])


def test_units_convert_per_joint() -> None:
    position = load_case("woodworking").position_range
    np.testing.assert_allclose(position, [[0, 0, -np.pi, -np.pi], [1, 1.5, np.pi, np.pi]])
    assert np.isinf(load_case("woodworking").problem.limits.upper).all()  # printed, not judged


# ---- files that a user might break ----------------------------------------------------------------


@pytest.fixture
def content() -> dict:
    raw = read_yaml(data_folder() / "cases" / "woodworking.yaml")
    raw.pop("variants")
    return raw


def _load(content: dict, folder: Path) -> object:
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump(content))
    return load_case(path)


def test_a_file_of_ones_own_loads(content: dict, tmp_path: Path) -> None:
    content["name"] = "my-case"
    assert _load(content, tmp_path).name == "my-case"
    assert load_case(str(tmp_path / "mine.yaml")).problem.n_segments == 3


def test_limits_of_a_variant_replace_one_kind_and_can_be_taken_away(content: dict, tmp_path: Path) -> None:
    jerk = {"values": [10, 10, 100, 100], "ours": "a test"}
    content["variants"] = {"more": {"title": "t", "reason": "r", "limits": {"jerk": jerk, "acceleration": None}}}
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(content))
    assert load_case(path).problem.limits.jerk[0] == np.inf
    from study.cases.library import _cases_in

    limits = _cases_in(path)["more"].problem.limits
    np.testing.assert_array_equal(limits.rates, [[0.6, 0.6, 1.8, 1.8], [np.inf] * 4, [10, 10, 100, 100]])


BREAKS = {
    "unknown key": (lambda c: c.update(wayponts=1), "unknown key 'wayponts'"),
    "missing key": (lambda c: c.pop("limits"), "'limits' is missing"),
    "NaN": (lambda c: c["waypoints"]["values"][1].__setitem__(2, float("nan")), "waypoints.values', item 3 of item 2"),
    "text": (lambda c: c["waypoints"]["values"][1].__setitem__(2, "x"), "waypoints.values', item 3 of item 2"),
    "wrong shape": (lambda c: c["waypoints"]["values"][1].pop(), "waypoints.values: row 2 .* 4 joints, got 3"),
    "one waypoint": (lambda c: c["waypoints"].update(values=c["waypoints"]["values"][:1]), "n_waypoints >= 2"),
    "zero limit": (lambda c: c["limits"]["velocity"]["values"].__setitem__(1, 0.0), "limits.velocity.values', item 2"),
    "short limit": (lambda c: c["limits"]["velocity"]["values"].pop(), "limits.velocity.values"),
    "unit": (lambda c: c.update(units=["m", "m", "rad", "turn"]), "units', item 4"),
    "equal neighbours": (
        lambda c: c["waypoints"]["values"].__setitem__(1, c["waypoints"]["values"][0]),
        "waypoints 1 and 2 are equal",
    ),
    "empty box": (lambda c: c["duration_bounds"].update(lower=6.0), "duration bounds"),
    "zero box": (lambda c: c["duration_bounds"].update(lower=0.0), "duration_bounds.lower"),
    "no origin": (lambda c: c["waypoints"].pop("source"), "exactly one of 'source'"),
    "curve": (lambda c: c.update(curve="poly535"), "no curve 'poly535'; did you mean 'poly353'"),
    "end": (lambda c: c.update(end="stop"), "field 'end'"),
    "published joint": (lambda c: c["published"][1].update(joint=5), "published.1.joint"),
    "published durations": (lambda c: c["published"][1]["durations"].pop(), "published.1.durations"),
}


@pytest.mark.parametrize("name", BREAKS)
def test_a_broken_file_says_where_in_one_sentence(name: str, content: dict, tmp_path: Path) -> None:
    breaking, message = BREAKS[name]
    breaking(content)
    with pytest.raises(StudyError, match=message) as caught:
        _load(content, tmp_path)
    text = str(caught.value)
    assert "mine.yaml" in text
    assert "\n" not in text
    assert "pydantic" not in text


def test_files_that_are_no_mapping_or_no_yaml(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    for text, message in (
        ("- 1\n- 2\n", "mapping"),
        ("a: [1, 2\nb: 3\n", "not valid YAML at line"),
        ("a: !!python/object:os.system {}\n", "not valid YAML"),
        ("", "mapping"),
    ):
        path.write_text(text)
        with pytest.raises(StudyError, match=message):
            load_case(path)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(StudyError, match="cannot be read"):
        load_case(path)
    with pytest.raises(StudyError, match="does not exist"):
        load_case(tmp_path / "other.yaml")
    (tmp_path / "folder.yaml").mkdir()
    with pytest.raises(StudyError, match="cannot be read"):
        load_case(tmp_path / "folder.yaml")


def test_unknown_names_come_with_a_hint() -> None:
    with pytest.raises(StudyError, match="did you mean 'woodworking'"):
        load_case("wodworking")


def test_data_is_found_inside_an_installed_package_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import study.datafiles as datafiles

    package = tmp_path / "study"
    shutil.copytree(data_folder() / "cases", package / "data" / "cases")
    monkeypatch.setattr(datafiles, "PACKAGE", package)
    assert datafiles.data_folder.__wrapped__() == package / "data"
    monkeypatch.setattr(datafiles, "PACKAGE", tmp_path / "nowhere" / "study")
    with pytest.raises(StudyError, match="no data folder"):
        datafiles.data_folder.__wrapped__()
