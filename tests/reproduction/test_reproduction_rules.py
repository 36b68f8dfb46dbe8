"""From printed numbers to verdicts: the comparisons, what arithmetic allows, rows of durations."""

import numpy as np
import pytest
from scipy import stats

from study.cases.library import load_case
from study.cases.published import Cell, tables
from study.errors import StudyError
from study.reproduction import rules
from study.reproduction.arithmetic import Statistics, examine, grain, largest, outside_extremes
from study.reproduction.benchmark_table import RUNS, BenchmarkTable
from study.reproduction.duration_rows import Row, added_up, infeasible, rule
from study.reproduction.effort import Effort
from study.reproduction.in_print import printed_value, rulings_in_print
from study.reproduction.jobs import Runs
from study.reproduction.motion_runs import judged, summarised, synchronised
from study.reproduction.uniformity import chi_squares, more_uniform
from study.reproduction.verdicts import RULES, Outcome, Place, Ruling, claim, strongest
from study.testfunctions import benchmarks_of

TINY = Effort("tiny", 2, 0.02, 2)


def cell(printed, row="r", column="c"):
    return Cell(row, column, "value", printed, rules.parsed(printed))


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
        ("3.73248 x 10^1", 300.0, 0.0, Outcome.REPRODUCED),
        ("3.73248 x 10^1", 1.0, 0.0, Outcome.BETTER),
        ("3.73248 x 10^1", 400.0, 0.0, Outcome.WORSE),
        ("0", 1e-200, 0.0, Outcome.REPRODUCED),
        ("0", 0.4, 0.0, Outcome.WORSE),
        ("-3.8563", -3.8628, -3.86278, Outcome.BETTER),
        ("-3.86", -3.8628, -3.86278, Outcome.REPRODUCED),
        ("9.9800e-01", 0.998003838, 0.998003837, Outcome.REPRODUCED),
        ("9.9800e-01", 1.992, 0.998003837, Outcome.WORSE),
    ],
)
def test_results_of_random_runs(printed, ours, least, outcome):
    assert rules.stochastic(printed, ours, least).outcome is outcome


def test_times_exact_numbers_and_counts():
    assert rules.duration("7.8776 s", 7.8780).outcome is Outcome.REPRODUCED
    assert rules.duration("7.8776 s", 7.5).outcome is Outcome.BETTER
    assert rules.duration("7.8776 s", 8.5, spread=(7.8, 9.0)).outcome is Outcome.REPRODUCED
    assert rules.duration("7.8776 s", 8.5, spread=(8.0, 9.0)).outcome is Outcome.WORSE
    assert rules.exact("40.2%", 40.17, Outcome.CONTRADICTS).outcome is Outcome.REPRODUCED
    assert rules.exact("1.49", np.radians(85.8), Outcome.CONTRADICTS).outcome is Outcome.CONTRADICTS
    assert rules.count("18.2", 25).outcome is Outcome.REPRODUCED
    assert rules.count("18.2", 70).outcome is Outcome.WORSE
    assert rules.count("within the 60 generations", 3, at_most=True).outcome is Outcome.REPRODUCED
    with pytest.raises(StudyError, match="holds no number"):
        rules.count("many", 3)


def test_rank_sum_is_scipys_and_ties_everywhere_say_nothing():
    rng = np.random.default_rng(2)
    a, b = rng.normal(0, 1, 30).tolist(), rng.normal(2, 1, 30).tolist()
    assert rules.rank_sum(a, b) == pytest.approx(stats.mannwhitneyu(a, b).pvalue)
    assert rules.smaller(a, b)[0]
    assert not rules.smaller(b, a)[0]
    assert rules.rank_sum([0.0] * 5, [0.0] * 5) == 1.0


def test_the_stated_precedence():
    worse = Ruling(Outcome.WORSE, "8", "ours", False)
    broken, said = Ruling(Outcome.INFEASIBLE, why="limit"), Ruling(Outcome.CONTRADICTS, why="sum")
    assert strongest(None, worse) is worse
    assert strongest(said, broken, worse) == Ruling(Outcome.CONTRADICTS, "8", "sum", False)
    assert strongest(rules.impossible("x <= y fails"), said, worse).outcome is Outcome.IMPOSSIBLE
    assert set(RULES) == set(Outcome)


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
    """Three misprinted exponents and the swarm that left its box."""
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
    assert set(ruled.values()) == {Outcome.INFEASIBLE}
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
    assert wood[claim("reduction-before")].outcome is Outcome.REPRODUCED
    assert wood[claim("abstract-reduction-before")].outcome is Outcome.CONTRADICTS
    assert wood[claim("spread-12-pso")].outcome is Outcome.CONTRADICTS
    assert wood[claim("population")].outcome is Outcome.USED
    aubo = rulings_in_print("aubo-dynamic-adaptive-pso")
    assert aubo[Place("Table 4", "K1", "theta3 (rad)")].outcome is Outcome.CONTRADICTS
    assert aubo[Place("Table 4", "K1", "theta3 (deg)")].outcome is Outcome.USED
    assert rulings_in_print("ur5-smwoa")[claim("total-before")].outcome is Outcome.NOT_REPRODUCIBLE


def test_terms_of_rules_are_printed_numbers():
    assert printed_value("ur5-smwoa", "Table 6 / SMA / h1 + h2") == pytest.approx(10.705)
    with pytest.raises(StudyError, match="takes 'totl', which is no claim"):
        printed_value("ur5-smwoa", "totl")


def test_uniformity_of_maps():
    assert 7 < np.median(chi_squares("uniform")) < 10  # nine degrees of freedom
    assert more_uniform("circle", ["uniform"]).outcome is Outcome.WORSE
    assert more_uniform("uniform", ["circle", "logistic", "singer"]).outcome is Outcome.REPRODUCED


def test_printed_tables_keep_their_least_values():
    assert tables("ur5-smwoa")["Table 2"].value("F13, Goldstein-Price", "optimal value") == 3.0
