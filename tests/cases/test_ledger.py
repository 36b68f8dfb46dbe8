"""The ledger: well formed, and its arithmetic recomputed from the printed cells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from study.cases.ledger import ledger
from study.cases.library import load_case
from study.cases.published import claims, papers, tables
from study.curves import curve_named
from study.errors import StudyError
from study.formulation import Scaled, stretch
from study.judge import judge
from study.reproduction.rules import half_unit
from study.robots import robot_named

WOOD, AUBO, SMWOA, SSA, PUMA = (
    "woodworking-golds-pso", "aubo-dynamic-adaptive-pso", "ur5-smwoa", "ur5-tadf-ssa", "puma560-chaotic-spso",
)  # fmt: skip


def test_every_paper_has_its_part() -> None:
    assert {entry.paper for entry in ledger()} == set(papers())
    assert sum(len(ledger(paper)) for paper in papers()) == len(ledger()) >= 100
    assert {entry.kind for entry in ledger()} == {"misprint", "contradiction", "gap", "ambiguity"}


def test_lookups() -> None:
    assert next(entry.paper for entry in ledger() if entry.id == "ssa-pitch") == SSA
    with pytest.raises(StudyError, match="no paper"):
        ledger("nobody")


def quoted(entry_id: str, *numbers: str) -> None:
    """The entry really states these numbers."""
    entry = next(entry for entry in ledger() if entry.id == entry_id)
    text = " ".join((entry.printed, entry.problem, entry.reading, entry.consequence))
    for number in numbers:
        assert number in text, (entry_id, number)


def test_woodworking_rows_that_do_not_add_up() -> None:
    table = tables(WOOD)["Table 5"]
    wrong = {}
    for row in {cell.row for cell in table.cells}:
        total = sum(table.value(row, f"t{i}") for i in (1, 2, 3))
        if abs(total - table.value(row, "T_total")) > 1.5e-4:  # rounding of the three terms
            wrong[row] = total
    assert set(wrong) == {f"PSO, joint {j}" for j in (1, 2, 3)}
    for j in (1, 2, 3):
        quoted(f"woodworking-table5-pso-{j}", f"{wrong[f'PSO, joint {j}']:.4f}")


def test_woodworking_totals_and_reductions() -> None:
    table, said = tables(WOOD)["Table 5"], claims(WOOD)
    for label, key in (("PSO", "pso"), ("Gold-SA", "gold-sa"), ("GoldS-PSO", "golds-pso")):
        maxima = [max(table.value(f"{label}, joint {j}", f"t{i}") for j in range(1, 5)) for i in (1, 2, 3)]
        assert sum(maxima) == pytest.approx(said[f"total-{key}"].value, abs=1e-9)
    assert said["total-golds-pso"].value != said["total-conclusions"].value
    best = said["total-golds-pso"].value
    for key, other in (("before", 15.0), ("pso", said["total-pso"].value), ("gold-sa", said["total-gold-sa"].value)):
        saved = 100 * (1 - best / other)
        assert saved == pytest.approx(said[f"reduction-{key}"].value, abs=5e-4)
        assert abs(saved - said[f"abstract-reduction-{key}"].value) > 0.1
        quoted("woodworking-reductions", f"{saved:.3f}")


def test_woodworking_differences_were_taken_from_the_wrong_sums() -> None:
    table, said = tables(WOOD)["Table 5"], claims(WOOD)
    for pair, first, second in (("12", 1, 2), ("34", 3, 4)):
        for label, key in (("PSO", "pso"), ("Gold-SA", "gold-sa"), ("GoldS-PSO", "golds-pso")):
            totals = [table.value(f"{label}, joint {j}", "T_total") for j in (first, second)]
            assert abs(totals[0] - totals[1]) == pytest.approx(said[f"spread-{pair}-{key}"].value, abs=1e-9)


@pytest.mark.parametrize(
    ("entry", "row", "column"),
    [("woodworking-table3-f1-cfpso-std", "F1", "CFPSO"), ("woodworking-table3-f6-pso-std", "F6", "PSO")],
)
def test_woodworking_impossible_deviations(entry: str, row: str, column: str) -> None:
    """Among n values with mean m and minimum b the sample deviation is at most sqrt(n) (m - b)."""
    table = tables(WOOD)["Table 3"]
    impossible = set()
    for i in range(1, 9):
        for name in table.columns:
            mean, best, std = (table.value(f"F{i}, {kind}", name) for kind in ("Mean", "Best", "Std"))
            if std > 1.01 * np.sqrt(30) * (mean - best):
                impossible.add((f"F{i}", name))
    assert (row, column) in impossible
    assert len(impossible) == 2
    mean, best = (table.value(f"{row}, {kind}", column) for kind in ("Mean", "Best"))
    quoted(entry, f"{np.sqrt(30) * (mean - best):.2f}")


def test_woodworking_f5_bound() -> None:
    most = sum(i * 1.28**4 for i in range(1, 31)) + 1.0
    assert tables(WOOD)["Table 3"].value("F5, Mean", "PSO") > most
    quoted("woodworking-table2-f5-bound", f"{most:.1f}")


def test_woodworking_shared_optimum_beats_the_maximum_rule() -> None:
    """The durations quoted as the joint optimum are feasible and shorter; a search found them once."""
    problem, curve = load_case("woodworking").problem, curve_named("poly353")
    durations = np.array([[2.27229377, 2.68701076, 2.51631604]])
    assert stretch(problem, curve, durations)[0] == pytest.approx(1.0, abs=1e-6)
    quoted("woodworking-maximum-rule", f"{durations.sum():.4f}")


def test_aubo_columns_that_disagree() -> None:
    table = tables(AUBO)["Table 4"]
    wrong = set()
    for row in ("K1", "K2", "W1", "L1", "L2", "W2"):
        for j in range(1, 7):
            degrees, radians = (table.value(row, f"theta{j} ({unit})") for unit in ("deg", "rad"))
            if abs(np.radians(degrees) - radians) > 0.01:
                wrong.add((row, j))
    assert wrong == {("K1", 3), ("K2", 4)}
    truncated = {(r, j): np.trunc(100 * np.radians(table.value(r, f"theta{j} (deg)"))) / 100
                 for r, j in (("W1", 1), ("W1", 4), ("W2", 1), ("W2", 2))}  # fmt: skip
    for (row, j), value in truncated.items():
        printed = table.value(row, f"theta{j} (rad)")
        assert printed == pytest.approx(value)
        assert abs(printed - np.radians(table.value(row, f"theta{j} (deg)"))) > 0.005


def _fastest(case_name: str, joint: int | None, durations: list[float]) -> float:
    """Total of quoted optimal durations, after checking that they are feasible and that no neighbour is faster."""
    case = load_case(case_name)
    problem = case.problem if joint is None else case.problem.joint(joint)
    scaled = Scaled(problem, curve_named(case.curve))
    best = np.array([durations])
    noise = np.exp(0.02 * np.random.default_rng(3).standard_normal((2000, 3)))
    total = float(scaled(best)[0])
    assert total <= scaled(best * noise).min() + 1e-6
    assert judge(problem, curve_named(case.curve).motion(problem.waypoints, scaled.durations(best)[0])).feasible
    return total


@pytest.mark.parametrize(
    ("entry", "case", "joint", "durations", "total"),
    [
        ("aubo-figure14", "aubo-i5", 0, [1.30152, 0.99941, 1.17862], "3.4796"),
        ("aubo-figure14", "aubo-i5-radians", 0, [1.30098, 0.99952, 1.17355], "3.4740"),
        ("aubo-figure14", "aubo-i5-radians", 2, [0.59845, 0.46422, 0.62178], "1.6845"),
        ("aubo-total-2", "aubo-i5-condition-2", None, [1.05924, 0.93195, 1.15840], "3.1496"),
        ("puma-total", "puma560", None, [0.79334, 0.44092, 1.13420], "2.3685"),
    ],
)
def test_quoted_optima(entry: str, case: str, joint: int | None, durations: list[float], total: str) -> None:
    assert _fastest(case, joint, durations) == pytest.approx(float(total), abs=2e-4)
    quoted(entry, total)


def test_smwoa_moves_at_both_ends_and_leaves_a_third() -> None:
    case = load_case("ur5-bspline")
    (printed,) = [p for p in case.published if p.label == "SMWOA"]
    curve = curve_named("bspline")
    verdict = judge(case.problem, curve.motion(case.problem.waypoints, printed.durations))
    speeds = np.degrees(np.abs(verdict.end_velocity))
    quoted("smwoa-moving-ends", f"{speeds[0, 1]:.1f}", f"{speeds[1, 5]:.1f}")
    ratios = verdict.ratios.max(axis=1)
    shrunk = printed.total * stretch(case.problem, curve, printed.durations[None])[0]
    quoted("smwoa-durations-slack", f"{ratios[0]:.3f}", f"{ratios[1]:.3f}", f"{shrunk:.3f}")
    motion = curve.motion(case.problem.waypoints, printed.durations)
    extrema = motion.extrema(0)
    assert (extrema.lowest > case.position_range[0]).all()
    assert (extrema.highest < case.position_range[1]).all()


def test_smwoa_impossible_deviations() -> None:
    table = tables(SMWOA)["Table 3"]
    optima = [0.0] * 10 + [0.998004, 0.397887, 3.0, -3.86278, -10.1532]
    count = 0
    for i, optimum in enumerate(optima, start=1):
        for name in table.columns:
            mean, std = table.value(f"F{i}, Avg", name), table.value(f"F{i}, Std", name)
            count += std > 1.01 * np.sqrt(30) * (mean - optimum)
    quoted("smwoa-table3-std", f"{count} of 90")


def test_smwoa_ranks_and_mantissas() -> None:
    table = tables(SMWOA)["Table 3"]
    means = np.array([[table.value(f"F{i}, Avg", name) for name in table.columns] for i in range(1, 16)])
    ranks = (means < means[:, :1]).sum(axis=1) + 1
    assert (ranks[11], ranks[13]) == (4, 1)
    quoted("smwoa-table3-rank-claims", f"{ranks.mean():.4f}", f"{table.value('average ranking', 'SMWOA'):.4f}")
    mantissas = [table[f"F{i}, Avg", "SMA"].printed[:4] for i in range(1, 12)]
    assert [i + 1 for i, m in enumerate(mantissas) if m == "2.74"] == [1, 4, 7, 10]
    assert [i + 1 for i, m in enumerate(mantissas) if m == "3.75"] == [2, 5, 8]


def test_ssa_total_is_one_run_not_a_mean() -> None:
    said = claims(SSA)
    total = sum(cell.value for cell in tables(SSA)["Table 6"].cells)
    assert total == pytest.approx(said["total"].value, abs=1e-9)
    assert said["total"].value < said["best-tadf-ssa"].value


def test_ssa_uses_nearly_all_of_its_jerk() -> None:
    case = load_case("ur5-helix")
    (printed,) = [p for p in case.published if p.label == "TADF-SSA"]
    verdict = judge(case.problem, curve_named("cubic-spline").motion(case.problem.waypoints, printed.durations))
    assert verdict.feasible
    quoted("ssa-jerk-claim", f"{verdict.ratios[2, 0]:.3f}", f"{verdict.ratios[1, 1]:.3f}")
    quoted("ssa-end-jerk", f"{verdict.end_acceleration[0, 1]:.3f}")


def test_puma_velocity_limit_is_where_the_samples_peak() -> None:
    case = load_case("puma560")
    curve = curve_named("poly353")
    sampled, exact = [], []
    for joint in (0, 1, 4, 5):
        (row,) = [p for p in case.published if p.joint == joint]
        problem = case.problem.joint(joint)
        motion = curve.motion(problem.waypoints, row.durations)
        times = []  # each segment has its own clock, sampled every 0.01 s
        for start, end in zip(motion.knots[:-1], motion.knots[1:], strict=True):
            times.append(np.arange(start, end, 0.01))
        sampled.append(np.abs(motion(np.concatenate(times), 1)).max())
        exact.append(judge(problem, motion).worst_ratio)
    assert sampled == pytest.approx([np.pi] * 4, abs=2e-3)
    quoted("puma-velocity", *(f"{ratio:.4f}" for ratio in exact))


def test_puma_totals_and_reductions() -> None:
    said, table = claims(PUMA), tables(PUMA)["Table 6"]
    assert said["t1"].value + said["t2"].value + said["t3"].value == pytest.approx(said["total"].value, abs=1e-9)
    assert said["total"].value != table.value("RRT-SPSO", "total time")
    assert table.value("improved RRT", "total time") < table.value("RRT-SPSO", "total time")
    quoted("puma-saved", f"{3 - said['total'].value:.5f}")
    quoted(
        "puma-reductions",
        f"{100 * (1 - said['total'].value / 3):.1f}",
        f"{100 * (1 - said['total-proposed'].value / 3):.1f}",
    )


def test_puma_joints_1_and_6_are_mirror_images() -> None:
    waypoints = load_case("puma560").problem.waypoints
    steps = np.diff(waypoints, axis=0)
    np.testing.assert_allclose(steps[:, 0], -steps[:, 5], atol=2e-4)


def test_puma_cells_that_cannot_be() -> None:
    table = tables(PUMA)["Table 3"]
    outside, below = set(), set()
    for i in range(1, 7):
        for name in table.columns:
            low, mean, high, value = (table.value(f"F{i}, {kind}", name) for kind in ("min", "mean", "max", "value"))
            if not low <= value <= high:
                outside.add((f"F{i}", name))
            if mean < low:
                below.add((f"F{i}", name))
    assert outside == {("F4", "STOA"), ("F4", "SPSO"), ("F6", "STOA")}
    assert below == {("F4", "SPSO")}


def test_puma_smallest_deviations() -> None:
    table = tables(PUMA)["Table 3"]
    smallest = [min(table.columns, key=lambda name, i=i: table.value(f"F{i}, std", name)) for i in range(1, 7)]
    assert smallest == ["STOA", "SPSO", "STOA", "PSO", "SCA", "STOA"]


def test_puma_waypoints_leave_the_printed_ranges() -> None:
    waypoints = load_case("puma560").problem.waypoints
    printed = robot_named("puma560-table1").range
    assert (waypoints[:, 0] > printed[1, 0]).all()
    toolbox = robot_named("puma560").range
    assert (waypoints[:, [3, 4]] > toolbox[1, [3, 4]]).any(axis=0).all()


def test_the_puma_papers_own_arm_starts_and_ends_at_round_points() -> None:
    """Table 4 through Table 1's lengths; the printed sign of alpha1, or the Toolbox's lengths, give nothing round."""
    waypoints = load_case("puma560").problem.waypoints
    robot = robot_named("puma560-table1")
    assert load_case("puma560").robot == robot.name
    poses = robot.forward(waypoints)
    np.testing.assert_allclose(1000 * poses[[0, 3], :3, 3], [[100, 100, 10], [100, -70, 10]], atol=0.005)
    np.testing.assert_allclose(poses[:, :3, :3], np.broadcast_to(np.eye(3), (4, 3, 3)), atol=1e-4)
    quoted("puma-dh", "(100.0, 100.0, 10.0)", "(100.0, -70.0, 10.0)")
    turned = replace(robot, alpha=np.array([-np.pi / 2, *robot.alpha[1:]])).forward(waypoints)
    assert np.abs(turned[:, :3, :3] - np.eye(3)).max() > 1.9
    toolbox = 1000 * robot_named("puma560").forward(waypoints)[[0, 3], :3, 3]
    assert np.abs(toolbox - np.round(toolbox, -1)).max() > 2
    assert load_case("puma560-toolbox").robot == "puma560"


def test_the_jacobian_of_the_sparrow_paper_has_a_plus_sign() -> None:
    robot, rng = robot_named("ur5e-ssa"), np.random.default_rng(4)
    a2, a3, d5 = robot.a[1], robot.a[2], robot.d[4]
    for q in rng.uniform(-3, 3, (20, 6)):
        frames = robot.frames(q[None])[0]
        axes, origins = frames[:6, :3, 2], frames[:6, :3, 3]
        jacobian = np.vstack([np.cross(axes, frames[-1, :3, 3] - origins).T, axes.T])
        bracket = a2 * np.cos(q[1]) + a3 * np.cos(q[1] + q[2]) + d5 * np.sin(q[1:4].sum())
        assert np.linalg.det(jacobian) == pytest.approx(a2 * a3 * np.sin(q[4]) * np.sin(q[2]) * bracket, rel=1e-9)
    quoted("ssa-eq2-sign", "+ d5 s234")


def test_theta4_of_the_sparrow_paper_is_misprinted_and_its_wrist_is_that_of_another_tool_frame() -> None:
    robot, rng = robot_named("ur5e-ssa"), np.random.default_rng(5)
    for q in rng.uniform(-3, 3, (20, 6)):
        frame = robot.forward(q[None])[0]
        n, o, a = -frame[:3, 1], -frame[:3, 2], frame[:3, 0]
        (s1, s5, s6), (c1, c5, c6) = np.sin(q[[0, 4, 5]]), np.cos(q[[0, 4, 5]])
        assert o[1] * c1 - o[0] * s1 == pytest.approx(c5, abs=1e-12)
        assert np.exp(1j * q[5]) == pytest.approx(
            np.exp(1j * np.arctan2((n[0] * s1 - n[1] * c1) / s5, (a[0] * s1 - a[1] * c1) / s5)), abs=1e-9
        )
        printed = np.arctan2(o[2] * s5 + c5 * (n[2] * c6 - a[2] * s6), a[2] * c6 + n[2] * s6) - q[1] - q[2]
        mended = np.arctan2(o[2] * s5 + c5 * (a[2] * c6 + n[2] * s6), a[2] * s6 - n[2] * c6) - q[1] - q[2]
        assert abs(np.exp(1j * mended) - np.exp(1j * q[3])) < 1e-9
        assert abs(np.exp(1j * printed) - np.exp(1j * q[3])) > 1e-6
    quoted("ssa-eq4-theta4", "a_z s6 - n_z c6")


def test_digits_that_the_aubo_paper_cuts_off() -> None:
    table, cut = tables(AUBO)["Table 4"], set()
    for row in ("K1", "K2", "W1", "L1", "L2", "W2"):
        for j in range(1, 7):
            cell = table[row, f"theta{j} (rad)"]
            value = np.radians(table.value(row, f"theta{j} (deg)"))
            if half_unit(cell.printed) < abs(value - cell.value) < 2 * half_unit(cell.printed) <= 0.01:
                cut.add((row, j))
    assert {("W1", 4), ("W1", 6), ("W2", 1), ("W2", 2)} <= cut
    assert ("W1", 1) not in cut
    quoted("aubo-table4-truncation", "-0.1257", "1.4975")


def test_the_puma_motion_gets_rougher() -> None:
    case, after = load_case("puma560"), np.array([0.75865, 0.4297, 1.2283])
    peaks = [
        [np.maximum(-motion.extrema(k).lowest, motion.extrema(k).highest).max() for k in (2, 3)]
        for motion in (curve_named(case.curve).motion(case.problem.waypoints, d) for d in (np.ones(3), after))
    ]
    quoted("puma-smoother", f"{peaks[0][0]:.1f}", f"{peaks[1][0]:.1f}", f"{peaks[0][1]:.0f}", f"{peaks[1][1]:.0f}")
