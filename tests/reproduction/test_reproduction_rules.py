"""From printed numbers to verdicts: the comparisons, what arithmetic allows, rows of durations."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from study.cases.library import load_case
from study.cases.printed import Cell, parsed
from study.cases.published import tables
from study.errors import StudyError
from study.reproduction import rules, uniformity
from study.reproduction.arithmetic import Statistics, examine, grain, largest, outside_extremes, rounding
from study.reproduction.benchmark_table import RUNS, BenchmarkTable
from study.reproduction.duration_rows import Row, added_up, infeasible, rule
from study.reproduction.effort import Effort
from study.reproduction.in_print import printed_value, rulings_in_print
from study.reproduction.jobs import Runs
from study.reproduction.motion_runs import judged, summarised, synchronised
from study.reproduction.papers.smwoa import open_to, places
from study.reproduction.sampling import Statistic, compared, converse, in_every, rank_sum, resampled, smaller
from study.reproduction.uniformity import chi_squares, denser, gaps, lyapunov, more_even, more_uniform
from study.reproduction.verdicts import BASES, RULES, Basis, Outcome, Place, Ruling, claim, strongest
from study.search.smwoa import SMWOA
from study.testfunctions import benchmarks_of

TINY = Effort("tiny", 2, 0.02, 2)


def cell(printed, row="r", column="c"):
    return Cell(row, column, "value", printed, parsed(printed))


@pytest.mark.parametrize(
    ("printed", "half", "digits"),
    [
        ("3.59", 0.005, 3),
        ("1.41 s", 0.005, 3),
        ("−0.12", 0.005, 2),
        ("7.6576 x 10^-96", 0.5e-100, 5),
        ("2.6964e+01", 0.5e-3, 5),
        ("0.12322 x 10^1", 0.5e-4, 5),
        ("approximately 40 iterations", 0.5, 2),
    ],
)
def test_half_a_unit_of_the_last_digit(printed, half, digits):
    assert rules.half_unit(printed) == pytest.approx(half)
    assert rules.digits(printed) == digits


def test_rounding_a_number_never_moves_it_by_more_than_half_a_unit():
    rng = np.random.default_rng(0)
    for value in 10.0 ** rng.uniform(-200, 5, 300):
        for text in (f"{value:.3e}", f"{value:.3e}".replace("e", " x 10^")):
            assert abs(float(f"{value:.3e}") - value) <= rules.half_unit(text.replace("^+", "^")) * (1 + 1e-9)


def test_same_order_is_symmetric_and_knows_zero():
    rng = np.random.default_rng(1)
    for a, b in 10.0 ** rng.uniform(-4, 4, (200, 2)):
        assert rules.same_order(a, b) == rules.same_order(b, a) == (abs(np.log10(a / b)) <= 1)
    assert rules.same_order(0.0, 1e-300)
    assert not rules.same_order(0.0, 1e-30)
    assert rules.same_order(0.0, 1e-30, zero=1e-16)


@pytest.mark.parametrize(
    ("printed", "ours", "least", "outcome"),
    [
        ("3.73248 x 10^1", (35.0, 39.6), 0.0, Outcome.REPRODUCED),
        ("3.73248 x 10^1", (290.0, 310.0), 0.0, Outcome.SAME_ORDER),
        ("3.73248 x 10^1", (0.9, 1.1), 0.0, Outcome.BETTER),
        ("3.73248 x 10^1", (399.0, 401.0), 0.0, Outcome.WORSE),
        ("0", (1e-200, 3e-250), 0.0, Outcome.REPRODUCED),
        ("0", (0.4, 0.5), 0.0, Outcome.WORSE),
        ("-3.8563", (-3.8628, -3.8627), -3.86278, Outcome.BETTER),
        ("-3.86", (-3.8628, -3.8627), -3.86278, Outcome.REPRODUCED),
        ("9.9800e-01", (0.998003838, 0.998003839), 0.998003837, Outcome.REPRODUCED),
        ("9.9800e-01", (1.992, 1.993), 0.998003837, Outcome.WORSE),
    ],
)
def test_means_of_random_runs(printed, ours, least, outcome):
    finals = np.linspace(*ours, 30)
    ruling = rules.stochastic(printed, finals, Statistic.MEAN, 30, least)
    assert ruling.outcome is outcome
    assert ruling.spread


def test_ours_stands_in_the_notation_of_the_print():
    assert rules.alike("0.12322 x 10^1", 1.2761) == "1.276 x 10^0"
    assert rules.alike("2.6964e+01", 26.5) == "2.650e+01"
    assert rules.alike("0.42034", 0.39789) == "0.3979"
    assert rules.alike("1.0 x 10^-3", 0.0) == "0"


def test_both_numerically_zero_is_said():
    assert rules.stochastic("2.46 x 10^-214", [2e-304] * 30, Statistic.MEAN, 30).why == "both numerically zero"


def test_wider_scatter_of_ours_reproduces_no_more_times():
    """The same median with ever more scatter: the printed time never becomes a reproduced one by it."""
    rng = np.random.default_rng(7)
    noise = np.sort(rng.standard_normal(31))
    noise -= np.median(noise)
    for scatter in (0.01, 0.1, 0.5, 2.0):
        outcome = rules.duration("7.8776 s", 8.4373 + scatter * noise).outcome
        assert outcome in (Outcome.WORSE, Outcome.UNDECIDED), scatter
    assert rules.duration("7.8776 s", 7.80 + 0.1 * noise).outcome is Outcome.REPRODUCED
    assert rules.duration("7.8776 s", [7.8780] * 4).outcome is Outcome.REPRODUCED
    assert rules.duration("7.8776 s", [7.5] * 4).outcome is Outcome.BETTER


def test_a_mean_of_ten_is_compared_with_means_of_ten_and_a_best_with_bests():
    """S6: a mean of ten that lies among single runs is no mean of ten of them."""
    singles = 9.43 + 0.543 * stats.norm.ppf((np.arange(30) + 0.5) / 30)
    assert singles.min() < 9.95 < singles.max()
    assert rules.duration("9.95", singles).outcome is Outcome.UNDECIDED
    assert rules.duration("9.95", singles, "", Statistic.MEAN, 10).outcome is Outcome.BETTER
    assert rules.duration("9.44", singles, "", Statistic.MEAN, 10).outcome is Outcome.REPRODUCED
    best = np.median(resampled(singles, Statistic.BEST, 10))
    assert rules.duration(f"{best:.2f}", singles, "", Statistic.BEST, 10).outcome is Outcome.REPRODUCED
    assert rules.duration("9.85", singles, "", Statistic.BEST, 10).outcome is Outcome.BETTER


def test_numbers_without_chance_agree_to_half_a_unit_or_are_cut_off():
    assert rules.exact("40.2%", 40.17, Basis.PRINT).outcome is Outcome.CONSISTENT
    assert rules.exact("1008.1", 1008.0, Basis.FORMULA).outcome is Outcome.CONTRADICTS
    cut = rules.exact("1.49", np.radians(85.8), Basis.PRINT)
    assert (cut.outcome, cut.why) == (Outcome.CONSISTENT, "its digits are cut off, not rounded")
    assert rules.exact("1.50", np.radians(85.2), Basis.PRINT).outcome is Outcome.CONTRADICTS
    assert rules.exact("nearly 20%", 19.445, Basis.PRINT).outcome is Outcome.CONSISTENT
    assert rules.exact("approximately 21%", 19.445, Basis.PRINT).outcome is Outcome.CONTRADICTS
    assert rules.exact("0", 4.8e-14, Basis.FORMULA).ours == "0"


LEVELS = {"0.1 %": 43.0, "1 %": 20.0, "2 %": 16.0, "5 %": 13.0}


@pytest.mark.parametrize(
    ("printed", "agrees"),
    [
        ("about 15 iterations", True),
        ("approximately 40 iterations", True),
        ("about 70 iterations", False),
        ("within the 12 generations", False),
        ("within the 13 generations", True),
        ("10-20 iterations", True),
        ("at least the 43 generations", True),
        ("at least the 44 generations", False),
        ("fewer than 100 iterations", True),
    ],
)
def test_counts_agree_at_one_of_four_definitions_to_the_letter_of_the_print(printed, agrees):
    ruling = rules.count(printed, LEVELS, ["0.1 %"])
    assert (ruling.outcome is Outcome.REPRODUCED) == agrees
    assert ruling.outcome in (Outcome.REPRODUCED, Outcome.NOT_CONFIRMED)
    assert ruling.ours == "≥ 43 / 20 / 16 / 13"


def test_a_count_needs_a_number():
    with pytest.raises(StudyError, match="holds no number"):
        rules.count("many", LEVELS)


def test_a_reduction_against_another_search_is_judged_by_runs():
    fast, slow = np.linspace(7.8, 7.9, 30), np.linspace(9.3, 9.4, 30)
    assert rules.reduction("15.695%", slow, fast, True).outcome is Outcome.REPRODUCED
    assert rules.reduction("15.695%", slow, slow, True).outcome is Outcome.WORSE
    assert rules.reduction("40%", [15.0], fast).outcome is Outcome.BETTER


def test_rank_sum_is_scipys_and_ties_everywhere_say_nothing():
    rng = np.random.default_rng(2)
    a, b = rng.normal(0, 1, 30).tolist(), rng.normal(2, 1, 30).tolist()
    assert rank_sum(a, b) == pytest.approx(stats.mannwhitneyu(a, b).pvalue)
    assert smaller(a, b)[0]
    assert not smaller(b, a)[0]
    assert rank_sum([0.0] * 5, [0.0] * 5) == 1.0


def test_too_few_runs_are_undecided_and_enough_are_not():
    few = in_every({"joint 1": compared([1.0, 2.0, 3.0, 4.0], [2.5, 3.5, 4.5, 0.5])})
    assert few.outcome is Outcome.UNDECIDED
    assert "too few to tell" in few.why
    same = list(np.linspace(0, 1, 30))
    assert in_every({"joint 1": compared(same, same)}).outcome is Outcome.NOT_CONFIRMED
    assert in_every({"joint 1": compared([1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0])}).outcome is Outcome.REPRODUCED
    assert converse(few, "not slower").outcome is Outcome.UNDECIDED
    assert converse(in_every({"a": compared(same, same)}), "no faster").outcome is Outcome.REPRODUCED


def test_ties_leave_every_place_open_that_they_share():
    assert places([0.0, 0.0, 0.0, 5.0]) == (1, 3)
    assert places([4.4e-16, 1.0, 4.4e-16]) == (1, 2)
    assert places([3.0, 1.0, 2.0]) == (3, 3)
    assert open_to((1, 2), 1)
    assert not open_to((2, 3), 1)


def test_the_stated_precedence():
    worse = Ruling(Outcome.WORSE, "8", "ours", False)
    broken, said = Ruling(Outcome.INFEASIBLE, why="limit"), Ruling(Outcome.CONTRADICTS, why="sum")
    assert strongest(None, worse) is worse
    assert strongest(said, broken, worse) == Ruling(Outcome.CONTRADICTS, "8", "sum", False)
    assert strongest(Ruling(Outcome.EXCEEDS_INFERRED, basis=Basis.FORMULA), worse).basis is Basis.FORMULA
    assert strongest(rules.impossible("x <= y fails"), said, worse).outcome is Outcome.IMPOSSIBLE
    assert set(RULES) == set(Outcome)
    assert set(BASES) == set(Basis)


@pytest.mark.parametrize("paper", ["woodworking-golds-pso", "ur5-smwoa", "puma560-chaotic-spso"])
def test_samples_that_exist_are_never_called_impossible(paper):
    rng = np.random.default_rng(3)
    for function in benchmarks_of(paper):
        span = function.upper - function.lower
        for scale in (1.0, 1e-3, 1e-9):
            centre = function.upper - span / 2 if function.minimiser is None else function.minimiser
            shape = (RUNS, function.n_dimensions)
            points = np.clip(centre + scale * span * rng.uniform(-0.5, 0.5, shape), function.lower, function.upper)
            values = function(points, rng)
            for form in ("{:.2e}", "{:.4e}"):
                figures = values.mean(), values.std(ddof=1), values.min(), values.max()
                printed = [cell(as_printed(form.format(value))) for value in figures]
                assert examine(Statistics(*printed), RUNS, function) == {}, (function.label, scale)


def as_printed(text):
    mantissa, exponent = text.split("e")
    return f"{mantissa} x 10^{int(exponent)}"


def impossible_cells(paper):
    table = BenchmarkTable(paper, TINY, Runs({}))
    found = set()
    for function in table.functions:
        for column in table.table.columns:
            cells = {
                c.row.split(", ")[1]: c
                for c in table.table.cells
                if c.column == column and c.row.startswith(f"{function}, ")
            }
            roles = {"Mean": "mean", "Avg": "mean", "Std": "std", "Best": "best"}
            by_role = {roles[head]: one for head, one in cells.items() if head in roles}
            job = table.cell(function, column, table.readings(column)[0])
            found |= {(function, column, role) for role in examine(Statistics(**by_role), RUNS, job.benchmark)}
    return found


def test_the_woodworking_tables_impossible_cells():
    """Three misprinted exponents, and the swarm that started outside its box."""
    assert impossible_cells("woodworking-golds-pso") == {
        ("F1", "CFPSO", "std"),
        ("F6", "PSO", "std"),
        ("F8", "GoldS-PSO", "best"),
        ("F5", "PSO", "mean"),
    }


def test_the_smwoa_tables_impossible_deviations_are_23():
    found = impossible_cells("ur5-smwoa")
    assert sum(role == "std" for *_, role in found) == 23
    assert {("F6", "SMWOA", "mean"), ("F7", "SMWOA", "mean"), ("F7", "SMA", "mean")} <= found


def test_grains_and_largest_values():
    by_label = {f.label: f for f in benchmarks_of("woodworking-golds-pso")}
    assert grain(by_label["F1"]) == 0.0
    assert grain(by_label["F6"]) == pytest.approx(4.44e-17, rel=0.01)
    assert grain(by_label["F8"]) == pytest.approx(1.35e-33, rel=0.01)
    assert largest(by_label["F5"]) == pytest.approx(465 * 1.28**4 + 1)
    assert largest(by_label["F6"]) is None


ACKLEYS = 2.0**-48
"""Step of Ackley's function near its least value."""


@pytest.mark.parametrize(
    ("text", "finals", "statistic", "step", "outcome"),
    [
        ("6.4863 x 10^-16", [4e-15] * 25 + [7.6e-15] * 5, Statistic.STD, ACKLEYS, Outcome.REPRODUCED),
        ("8.8818e-16", [4.44089e-15] * 30, Statistic.MEAN, ACKLEYS, Outcome.REPRODUCED),
        ("5.39 x 10^-15", [4.44e-16, 4e-15, 4e-15] * 10, Statistic.MEAN, ACKLEYS, Outcome.REPRODUCED),
        ("0", [4.44e-16] * 30, Statistic.BEST, ACKLEYS, Outcome.REPRODUCED),
        ("2.0e-14", [4e-15] * 30, Statistic.MEAN, ACKLEYS, Outcome.SAME_ORDER),
        ("0", [0.0] * 28 + [1.0] * 2, Statistic.MEAN, 0.0, Outcome.WORSE),
    ],
)
def test_numbers_closer_than_a_functions_rounding_are_the_same(text, finals, statistic, step, outcome):
    assert rules.stochastic(text, finals, statistic, RUNS, rounding=step).outcome is outcome


def test_the_rounding_of_a_function_is_none_of_its_stairs():
    by_label = {f.label: f for f in benchmarks_of("woodworking-golds-pso")}
    assert rounding(by_label["F6"]) == pytest.approx(ACKLEYS, rel=1e-9)
    assert [rounding(by_label[label]) for label in ("F1", "F4")] == [0.0, 0.0]


def test_a_value_outside_its_extremes():
    cells = {"min": cell("1.0"), "max": cell("2.0")}
    assert outside_extremes(cell("2.4"), cells).inequality == "value 2.4 <= maximum 2 fails"
    assert outside_extremes(cell("0.4"), cells) is not None
    assert outside_extremes(cell("2.04"), cells) is None


def row(durations, total, case="woodworking", joint=None):
    segments = [cell(f"{value:.4f}", column=f"t{k}") for k, value in enumerate(durations, start=1)]
    return Row(segments, cell(total, column="T_total"), load_case(case), joint)


FASTEST = 7.4756


def test_a_row_that_does_not_add_up_contradicts_itself_though_it_is_feasible():
    kept, wrong = (row((2.3189, 2.9540, 2.6047), total) for total in ("7.8776", "7.8876"))
    assert added_up(kept) is None
    assert added_up(wrong).outcome is Outcome.CONTRADICTS
    assert infeasible(kept, FASTEST) is None


def test_shrinking_a_row_beyond_the_fastest_makes_it_infeasible():
    case = load_case("woodworking")
    found = row((2.0, 2.5, 2.2), "6.7000")
    ruled = {c.column: r.outcome for c, r in rule(found, None, FASTEST)}
    assert ruled == {"t1": Outcome.PART, "t2": Outcome.PART, "t3": Outcome.PART, "T_total": Outcome.INFEASIBLE}
    inferred = rule(replace(found, inferred=True), None, FASTEST)[-1][1]
    assert inferred.outcome is Outcome.EXCEEDS_INFERRED
    assert "inferred by us" in inferred.why
    assert not judged(case, found.durations).feasible


def test_rounding_excuses_a_row_only_where_it_leaves_room():
    """3.14 s cannot be 3.1496 s rounded; 3.15 s can."""
    case, fastest = load_case("aubo-i5-condition-2"), 3.1496
    printed = [cell(text) for text in ("1.09", "0.94", "1.11")]
    assert infeasible(Row(printed, cell("3.14"), case), fastest).outcome is Outcome.INFEASIBLE
    assert infeasible(Row(printed, cell("3.15"), case), fastest) is None


def test_our_runs_put_together_and_summarised():
    case = load_case("woodworking")
    records = [{"durations": [[2.0, 3.0, 2.0], [2.5, 3.0, 2.7]]}, {"durations": [[2.4, 2.0, 2.6], [2.0, 2.0, 2.0]]}]
    together = synchronised(records)
    assert together.tolist() == [[2.4, 3.0, 2.6], [2.5, 3.0, 2.7]]
    found = summarised(case, np.vstack([together, [1.0, 1.0, 1.0]]))
    assert (found.feasible, found.runs, found.best) == (2, 3, pytest.approx(8.0))
    assert summarised(case, np.ones((2, 3))) is None


def test_what_the_print_alone_decides():
    wood = rulings_in_print("woodworking-golds-pso")
    assert wood[claim("reduction-before")].outcome is Outcome.CONSISTENT
    assert wood[claim("reduction-before")].basis is Basis.PRINT
    assert wood[claim("abstract-reduction-before")].outcome is Outcome.CONTRADICTS
    assert wood[claim("spread-12-pso")].outcome is Outcome.CONSISTENT
    assert wood[claim("total-conclusions")].outcome is Outcome.CONTRADICTS
    assert wood[claim("population")].outcome is Outcome.USED
    aubo = rulings_in_print("aubo-dynamic-adaptive-pso")
    assert aubo[Place("Table 4", "K1", "theta3 (rad)")].outcome is Outcome.CONTRADICTS
    assert aubo[Place("Table 4", "K1", "theta3 (deg)")].outcome is Outcome.USED
    assert rulings_in_print("ur5-smwoa")[claim("total-before")].outcome is Outcome.NOT_REPRODUCIBLE


def test_terms_of_rules_are_printed_numbers():
    assert printed_value("ur5-smwoa", "Table 6 / SMA / h1 + h2") == pytest.approx(10.705)
    with pytest.raises(StudyError, match="takes 'totl', which is no claim"):
        printed_value("ur5-smwoa", "totl")


def test_uniformity_of_maps_at_the_papers_own_sizes():
    assert 7 < np.median(chi_squares("uniform")) < 10  # nine degrees of freedom
    assert more_uniform("circle", ["uniform"], (30, 50, 100, 1000), 2).outcome is Outcome.CONSISTENT
    assert more_uniform("circle", ["uniform"], (1000,)).outcome is Outcome.NOT_CONFIRMED
    assert more_uniform("uniform", ["circle", "logistic", "singer"]).basis is Basis.FORMULA
    assert more_even("circle", 100).agrees
    assert not more_even("logistic", 100).agrees
    assert denser("circle", 0.2, 0.6, 100).agrees
    assert not denser("circle", 0.7, 1.0, 100).agrees


def test_gaps_of_evenly_spaced_numbers_are_one(monkeypatch):
    monkeypatch.setattr(uniformity, "chaos_numbers", lambda name: np.linspace(0.05, 0.95, 10)[:, None])
    least, greatest = gaps("any", 10)
    assert least == pytest.approx(1.0)
    assert greatest == pytest.approx(1.0)


def test_the_sine_tent_cosine_map_is_chaotic_for_every_r():
    assert all(1.2 < lyapunov(r) < 1.5 for r in (0.05, 0.3, 0.7, 1.0))


def test_readings_carry_their_own_counts_and_fitted_ones_say_so():
    table = BenchmarkTable("woodworking-golds-pso", TINY, Runs({}))
    names = {column: [(r.name, r.fitted) for r in table.readings(column)] for column in table.table.columns}
    assert ("as cited", False) in names["CFPSO"]
    assert ("as cited", False) in names["SPSO"]
    assert ("cited lambda", False) in names["GoldS-PSO"]
    assert [fitted for _, fitted in names["Gold-SA"]] == [False, False]
    assert BenchmarkTable("ur5-smwoa", TINY, Runs({})).readings("SMWOA")[0].search == SMWOA()
    branin = BenchmarkTable("ur5-smwoa", TINY, Runs({})).stated("F12", "WOA").benchmark
    assert (branin.lower.tolist(), branin.upper.tolist()) == ([-5, -5], [5, 5])


def test_printed_tables_keep_their_least_values():
    assert tables("ur5-smwoa")["Table 2"].value("F13, Goldstein-Price", "optimal value") == 3.0
