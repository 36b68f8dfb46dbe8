from dataclasses import replace

import numpy as np
import pytest

from study.analysis.formatting import ratio
from study.cases.library import load_case
from study.comparison import ablations, audit, audit_functions, audit_trajectories, tasks
from study.comparison.audit_functions import ALARM, FunctionFinding, axes_audited, function_grid
from study.comparison.audit_trajectories import TrajectoryFinding
from study.comparison.effort import QUICK
from study.comparison.improvements import ABLATIONS, PLAIN, WHOLE
from study.comparison.outcomes import grouped
from study.comparison.tasks import DOSES, FunctionView, TrajectoryView
from study.comparison.trials import Trial, TrialJob, TrialOutcome
from study.curves import curve_named
from study.errors import StudyError
from study.formulation import Scaled
from study.search.random_search import RandomSearch
from study.search.smwoa import SMWOA
from study.search.woa import WOA

WOODWORKING = load_case("woodworking")
SMALL = replace(
    QUICK,
    functions=("sphere", "ackley"),
    dosed=("sphere",),
    dimensions=8,
    generations=120,
    function_seeds=4,
    trial_seeds=3,
)


@pytest.mark.parametrize("view", FunctionView)
def test_every_view_of_a_function_keeps_its_minimum_in_the_box(view):
    task = tasks.function_task("rastrigin", 6, view, seed=3)
    where = _minimiser(view)
    assert ((task.box.lower <= where) & (where <= task.box.upper)).all()
    assert task.objective(where[None])[0] == pytest.approx(task.minimum, abs=1e-9)


def _minimiser(view, seed=3):
    """Minimiser of a view, found from a sphere in the same view: rotation keeps it."""
    task = tasks.function_task("sphere", 6, view, seed)
    eye = np.eye(6)
    zero = task.objective(np.zeros((1, 6)))[0]
    slope = (task.objective(eye) - task.objective(-eye)) / 2
    half = 100.0  # of the sphere's box; shifts are shares of it
    curvature = (task.objective(eye) + task.objective(-eye)) / 2 - zero
    return -slope / 2 / curvature / half * 5.12


def test_shifts_differ_per_coordinate_and_grow_with_the_dose():
    sizes = []
    for view, dose in DOSES.items():
        shares = np.abs(_minimiser(view)) / 5.12
        assert len(set(np.round(shares / dose, 4))) == 6
        assert (shares <= dose * (1 + 1e-6)).all()
        assert (shares >= 0.25 * dose * (1 - 1e-3)).all()
        sizes.append(shares.max())
    assert sizes == sorted(sizes)
    assert not _minimiser(FunctionView.ORIGIN).any()


def test_the_diagonal_test_keeps_the_distance():
    on, off = _minimiser(FunctionView.DIAGONAL), _minimiser(FunctionView.OFF_DIAGONAL)
    assert np.ptp(on) == pytest.approx(0.0, abs=1e-9)
    assert np.abs(off) == pytest.approx(np.abs(on))
    assert np.ptp(off) > 1.0


def test_views_of_durations_are_the_same_problem():
    problem = WOODWORKING.problem
    lo, hi = problem.duration_bounds
    t = np.random.default_rng(0).uniform(lo, hi, (20, 3))
    direct = Scaled(problem, curve_named("poly353"))(t)
    seen = {view: tasks.trajectory_task(problem, "poly353", "scaled", view) for view in TrajectoryView}
    assert seen[TrajectoryView.AS_IT_IS].objective(t) == pytest.approx(direct, rel=1e-12)
    assert seen[TrajectoryView.REFLECTED].objective(lo + hi - t) == pytest.approx(direct, rel=1e-12)
    assert seen[TrajectoryView.CENTRED].objective(t - (lo + hi) / 2) == pytest.approx(direct, rel=1e-12)
    assert seen[TrajectoryView.CENTRED].box.lower == pytest.approx(-seen[TrajectoryView.CENTRED].box.upper)


def test_unknown_views_and_functions_are_named():
    with pytest.raises(StudyError, match="no function for the audit 'spere'; did you mean 'sphere'"):
        tasks.function_task("spere", 3, FunctionView.ORIGIN, 0)
    with pytest.raises(StudyError, match="no function view"):
        tasks.function_task("sphere", 3, "sideways", 0)
    with pytest.raises(StudyError, match="no trajectory view"):
        tasks.trajectory_task(WOODWORKING.problem, "poly353", "scaled", "sideways")


def test_error_ratio_and_geometric_mean_by_hand():
    assert audit_functions.error_ratio(np.array([2.0, 4.0]), np.array([1.0, 0.0])) == 6.0
    assert audit_functions.error_ratio(np.array([0.0]), np.array([1e-20])) == 1.0
    assert audit_functions.error_ratio(np.array([1e-3]), np.array([0.0])) == pytest.approx(1e5)
    assert audit_functions.geometric_mean([1.0, 100.0]) == pytest.approx(10.0)


def test_ratios_read_plainly():
    assert [ratio(x) for x in (0.97, 15.23, 253.4, 1000.0, 6821.0, 9999.9, 3.4e10)] == [
        "0.97", "15.2", "253", "1000", "6821", "1e4", "3e10",
    ]  # fmt: skip


def run_all(jobs):
    return {trial: end for job in jobs for trial, end in zip(job.trials, job.run(), strict=True)}


def _outcomes(values):
    return {
        Trial(search, task, view, seed, 10, 5, 3): TrialOutcome(value)
        for (search, task, view), several in values.items()
        for seed, value in enumerate(several)
    }


def test_function_findings_by_hand():
    found = audit_functions.function_findings(
        _outcomes(
            {
                ("a", "f", FunctionView.ORIGIN): [1.0, 3.0], ("a", "f", FunctionView.SHIFTED): [200.0, 600.0],
                ("a", "g", FunctionView.ORIGIN): [1.0], ("a", "g", FunctionView.SHIFTED): [1.0],
                ("b", "f", FunctionView.ORIGIN): [2.0], ("b", "f", FunctionView.SHIFTED): [1.0],
            }
        )
    )  # fmt: skip
    assert [one.search for one in found] == ["a", "b"]
    assert found[0].by_function == {"f": 200.0, "g": 1.0}
    assert found[0].shifted == pytest.approx(200**0.5)
    assert found[1].shifted == 0.5
    assert list(audit.flags_of(found, [])) == ["a"]


def test_one_run_that_is_stuck_decides_nothing_on_the_diagonal():
    values = {
        ("a", "f", FunctionView.ORIGIN): [1.0],
        ("a", "f", FunctionView.SHIFTED): [1.0],
        ("a", "f", FunctionView.DIAGONAL): [1.0, 2.0, 3.0],
    }
    stuck = audit_functions.function_findings(
        _outcomes(values | {("a", "f", FunctionView.OFF_DIAGONAL): [4.0, 3.0, 9000.0]})
    )
    assert stuck[0].diagonal == 2.0
    worse = audit_functions.function_findings(
        _outcomes(values | {("a", "f", FunctionView.OFF_DIAGONAL): [1.0, 80.0, 90.0]})
    )
    assert worse[0].diagonal == 40.0
    assert list(audit.flags_of(worse, [])) == ["a"]


def test_trajectory_findings_by_hand():
    durations = {
        ("a", TrajectoryView.AS_IT_IS): [1.0, 2.0, 3.0], ("a", TrajectoryView.REFLECTED): [4.0, 5.0, 6.0], ("a", TrajectoryView.CENTRED): [1.0, 2.0, 3.0],
        ("b", TrajectoryView.REFLECTED): [1.0, 1.0, 1.0],
    }  # fmt: skip
    found = audit_trajectories.trajectory_findings(
        {
            Trial(search, "case", view, seed, 10, 5, formulation="penalty"): TrialOutcome(value)
            for (search, view), values in durations.items()
            for seed, value in enumerate(values)
        }
    )
    reflected, centred = found  # of b there is nothing to compare with
    assert (reflected.as_they_are, reflected.seen, reflected.a12) == (2.0, 5.0, 1.0)
    assert reflected.p == pytest.approx(2 * 2 / 20)  # 2 of C(6, 3) arrangements are as extreme; two findings
    assert not reflected.depends  # however large
    assert (centred.a12, centred.p) == (0.5, 1.0)


def test_turned_axes_are_marked_and_raise_no_flag():
    one = FunctionFinding("a", {"f": 2.0}, 2.0, 99.0, {}, 2.0)
    assert audit.flags_of([one], []) == {}
    assert "99 ↻" in function_grid([one], {}).rows[0]
    assert "9.9" in function_grid([replace(one, rotated=9.9)], {}).rows[0]
    assert "1 of 2 searches" in axes_audited([one, replace(one, rotated=9.9)])
    assert "a (99)" in axes_audited([one])


def test_flags_name_the_view_that_matters():
    functions = [FunctionFinding("a", {}, 2.0, 99.0, {}, 20.0), FunctionFinding("b", {}, 2.0, 2.0, {}, 2.0)]
    seen = [
        TrajectoryFinding("b", "case-1", "penalty", TrajectoryView.REFLECTED, 5.0, 6.0, 0.9, 0.01),
        TrajectoryFinding("c", "case-1", "penalty", TrajectoryView.REFLECTED, 5.0, 6.0, 0.9, 0.06),
        TrajectoryFinding("c", "case-1", "penalty", TrajectoryView.CENTRED, 5.0, 5.1, 0.6, 0.01),
    ]
    flags = audit.flags_of(functions, seen)
    assert flags.keys() == {"a", "b"}
    assert "leaves the diagonal" in flags["a"]
    assert "case-1" in flags["b"]


def test_the_audit_flags_those_that_contract_and_not_the_standard_ones():
    every = audit.audited_searches(printed=False)
    biased, sound = {"gold-sa", "golds-pso", "simple-pso", "woa", "ssa"}, {"pso", "de", "random-search"}
    jobs = audit_functions.function_jobs({name: every[name] for name in biased | sound}, SMALL)
    found = audit_functions.function_findings(run_all([job for job in jobs if job.trial.view in ("origin", "shifted")]))
    ratios = {one.search: one.shifted for one in found}
    assert {name for name, ratio in ratios.items() if ratio > ALARM} == biased


def test_random_search_is_blind_to_the_view_up_to_rounding():
    jobs = audit_trajectories.trajectory_jobs({"r": RandomSearch()}, [WOODWORKING], SMALL, ["scaled"])
    values = grouped(run_all(jobs))
    same = [values["r", "woodworking", "scaled", view] for view in (TrajectoryView.AS_IT_IS, TrajectoryView.CENTRED)]
    assert same[0] == pytest.approx(same[1], rel=1e-9)


def test_a_search_that_breaks_down_is_a_record():
    trial = Trial("de", "sphere", FunctionView.ORIGIN, 0, 20, 2, 3)
    (outcome,) = TrialJob(trial, audit.audited_searches(False)["de"], range(1)).run()
    assert outcome.value == np.inf
    assert outcome.reason.startswith("StudyError")


def test_ablations_switch_one_thing_at_a_time():
    assert {one.paper for one in ABLATIONS} == {load_case(n).paper for n in _papers_cases()}
    for one in ABLATIONS:
        plain = vars(one.forms[PLAIN])
        changed = {
            name: {field for field, value in vars(search).items() if value != plain[field]}
            for name, search in one.forms.items()
        }
        singles = [fields for name, fields in changed.items() if name not in (PLAIN, WHOLE)]
        assert len(singles) >= 3
        assert all(len(fields) == 1 for fields in singles)
        assert changed[WHOLE] <= set().union(*singles)


def _papers_cases():
    return ("woodworking", "aubo-i5", "ur5-bspline", "ur5-helix", "puma560")


def test_plain_smwoa_is_woa():
    trial = Trial("", "sphere", FunctionView.SHIFTED, 2, 400, 20, 5)
    smwoa = next(one for one in ABLATIONS if one.title == "SMWOA").forms[PLAIN]
    assert isinstance(smwoa, SMWOA)
    assert TrialJob(trial, smwoa, range(2, 4)).run() == TrialJob(trial, WOA(), range(2, 4)).run()


def _ablation(values):
    return ablations.ablation_findings(
        {
            Trial(
                f"ur5-smwoa: {form}", "case", TrajectoryView.AS_IT_IS, seed, 10, 5, formulation="penalty"
            ): TrialOutcome(value)
            for form, several in values.items()
            for seed, value in enumerate(several)
        }
    )


def test_ablation_findings_by_hand():
    plain = [10.0 + 0.1 * k for k in range(10)]
    found = {
        one.improvement: one
        for one in _ablation({"plain": plain, "arctanh a": [x - 5 for x in plain], "oscillation": plain})
    }
    helps, nothing = found["arctanh a"], found["oscillation"]
    assert helps.a12 == 1.0
    assert helps.difference.estimate == pytest.approx(-5 / 10.45)
    assert helps.p == pytest.approx(2 * 2 / 2**10)  # two forms on the task
    assert helps.effect == "helps"
    assert (nothing.a12, nothing.p, nothing.effect) == (0.5, 1.0, "none")
