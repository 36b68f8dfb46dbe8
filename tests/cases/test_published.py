"""What the papers print: how many cells, that they parse, and what follows from them."""

from __future__ import annotations

import csv

import numpy as np
import pytest

from study.cases.printed import parsed
from study.cases.published import claims, main_claims, papers, statements, tables
from study.datafiles import data_folder
from study.errors import StudyError

COUNTS = {  # rows x columns of the printed tables
    "woodworking-golds-pso": {"Table 1": 4 * 5, "Table 2": 8 * 4, "Table 3": 8 * 3 * 5, "Table 4": 4 * 4, "Table 5": 12 * 4},
    "aubo-dynamic-adaptive-pso": {"Table 1": 6 * 4, "Table 2": 2 * 12, "Table 3": 3 * 6, "Table 4": 7 * 12, "Table 5": 4 * 4},
    "ur5-smwoa": {"Table 2": 15 * 4, "Table 3": 15 * 2 * 6 + 3 * 6, "Table 4": 6 * 6, "Table 5": 3 * 6, "Table 6": 3 * 6},
    "ur5-tadf-ssa": {"Table 1": 6 * 4, "Table 2": 7 * 3, "Table 3": 7 * 6, "Table 4": 3 * 5, "Table 5": 2 * 4, "Table 6": 19},
    "puma560-chaotic-spso": {
        "Table 1": 6 * 5,
        "Table 2": 6 * 2,
        "Table 3": 6 * 6 * 4,
        "Table 4": 4 * 6,
        "Table 5": 4 * 7,
        "Table 6": 4,
    },
}  # fmt: skip
NOT_NUMBERS = {("woodworking-golds-pso", "Table 1"), ("aubo-dynamic-adaptive-pso", "Table 1"), ("ur5-tadf-ssa", "Table 1"),
               ("puma560-chaotic-spso", "Table 1"), ("ur5-smwoa", "Table 2"), ("ur5-smwoa", "Table 3")}  # fmt: skip


@pytest.mark.parametrize("paper", COUNTS)
def test_cells_per_table(paper: str) -> None:
    assert {number: len(table.cells) for number, table in tables(paper).items()} == COUNTS[paper]


def test_papers_are_the_five() -> None:
    assert set(papers()) == set(COUNTS)


@pytest.mark.parametrize("paper", COUNTS)
def test_every_cell_of_a_numeric_table_is_a_number(paper: str) -> None:
    for number, table in tables(paper).items():
        odd = [cell.printed for cell in table.cells if cell.value is None]
        assert not odd or (paper, number) in NOT_NUMBERS


@pytest.mark.parametrize("paper", COUNTS)
def test_claims_agree_with_their_print(paper: str) -> None:
    for claim in claims(paper).values():
        digits = (
            f"{abs(claim.value):,.15g}",
            f"{abs(claim.value):.15g}",
            f"{abs(claim.value):.4f}",
            f"{claim.value:.9f}",
        )
        words = {3: "three", 4: "four", 6: "six", 8: "eight", 10: "ten", 0.000054567: "0.000054567"}.get(
            claim.value, ""
        )
        assert any(text in claim.printed for text in digits) or (words and words in claim.printed), claim
        assert claim.place


@pytest.mark.parametrize(
    ("printed", "value"),
    [
        ("0.800 m", 0.8),
        ("3.73248 x 10^1", 37.3248),
        ("1.3947 x 10^-77", 1.3947e-77),
        ("2.6964e+01", 26.964),
        ("−40.9", -40.9),
        ("-pi/2", -np.pi / 2),
        ("3*pi/4", 3 * np.pi / 4),
        ("29.5%", 29.5),
        ("theta1", None),
        ("(lost)", None),
        ("0 to 1000 mm", None),
        ("-", None),
    ],
)
def test_parsing(printed: str, value: float | None) -> None:
    assert parsed(printed) == (None if value is None else pytest.approx(value, rel=1e-15))


def test_quantities_are_told_apart() -> None:
    benchmark = tables("woodworking-golds-pso")["Table 3"]
    assert [benchmark[f"F1, {kind}", "PSO"].quantity for kind in ("Mean", "Best", "Std")] == ["mean", "best", "std"]
    times = tables("woodworking-golds-pso")["Table 5"]
    assert times["PSO, joint 1", "T_total"].quantity == "total"
    assert times["PSO, joint 1", "t1"].quantity == "duration"


def test_lookups_fail_with_a_hint() -> None:
    with pytest.raises(StudyError, match="did you mean 'ur5-smwoa'"):
        tables("ur5-smwo")
    table = tables("ur5-smwoa")["Table 6"]
    with pytest.raises(StudyError, match="no cell of Table 6"):
        table.value("SMWOA", "h6")
    with pytest.raises(StudyError, match="is not a number"):
        tables("ur5-smwoa")["Table 2"].value("F8, Alpine", "dimension")


def test_tables_that_add_up() -> None:
    smwoa = tables("ur5-smwoa")["Table 6"]
    for row in ("SMA", "WOA", "SMWOA"):
        assert sum(smwoa.value(row, f"h{i}") for i in range(1, 6)) == pytest.approx(smwoa.value(row, "total"), abs=1e-9)
    aubo = tables("aubo-dynamic-adaptive-pso")["Table 5"]
    for row in ("condition 1", "condition 2"):
        stages = [aubo.value(row, f"{stage} stage") for stage in ("first", "second", "third")]
        assert sum(stages) == pytest.approx(aubo.value(row, "total time"), abs=1e-9)
        saved = [100 * (1 - stage / 2) for stage in stages]
        printed = [aubo.value(f"{row}, improvement", f"{stage} stage") for stage in ("first", "second", "third")]
        assert saved == pytest.approx(printed, abs=0.051)
    puma = tables("puma560-chaotic-spso")["Table 5"]
    for joint in range(1, 7):
        times = [puma.value(f"time {i}", f"joint {joint}") for i in (1, 2, 3)]
        assert sum(times) == pytest.approx(puma.value("total time", f"joint {joint}"), abs=5.1e-5)


def test_reductions_that_follow() -> None:
    smwoa, ssa, aubo = (claims(p) for p in ("ur5-smwoa", "ur5-tadf-ssa", "aubo-dynamic-adaptive-pso"))
    assert 100 * (1 - smwoa["total"].value / smwoa["total-before"].value) == pytest.approx(37.674, abs=5e-4)
    assert 100 * (1 - ssa["total"].value / ssa["total-before"].value) == pytest.approx(82.68, abs=5e-3)
    saving = 100 * (1 - ssa["ik-time-domain"].value / ssa["ik-time-eight"].value)
    assert saving == pytest.approx(ssa["ik-saving"].value, abs=5e-3)
    for condition in ("1", "2"):
        saved = 100 * (1 - aubo[f"total-{condition}"].value / aubo["total-before"].value)
        assert saved == pytest.approx(aubo[f"reduction-{condition}"].value, abs=0.05)


def inventory() -> list[dict[str, str]]:
    """Everything that the papers' prose says in numbers or compares, with the section and where it is ruled on."""
    with (data_folder() / "published" / "inventory.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


COUNTED = {  # numbers and comparative sentences of the prose, counted in the papers' texts
    "woodworking-golds-pso": (50, 22), "aubo-dynamic-adaptive-pso": (28, 9), "ur5-smwoa": (9, 10), "ur5-tadf-ssa": (32, 12),
    "puma560-chaotic-spso": (54, 27),
}  # fmt: skip


@pytest.mark.parametrize("paper", COUNTED)
def test_the_inventory_holds_every_number_and_sentence_of_the_prose(paper: str) -> None:
    own = [row for row in inventory() if row["paper"] == paper]
    assert [sum(row["kind"] == kind for row in own) for kind in ("number", "sentence")] == list(COUNTED[paper])
    ruled = {(row["ruled at"], row["section"]) for row in own if row["kind"] in ("number", "sentence")}
    assert ruled == {(entry.id, entry.place) for entry in (*claims(paper).values(), *statements(paper))}


def test_what_is_said_again_names_the_verdict_that_decides_it() -> None:
    for row in inventory():
        known = {
            *claims(row["paper"]),
            *(statement.id for statement in statements(row["paper"])),
            *tables(row["paper"]),
        }
        ids = [row["ruled at"]] if row["ruled at"].startswith("Table") else row["ruled at"].split()
        assert set(ids) <= known, row
        assert ids or row["kind"] in ("equation", "equipment or citation"), row


@pytest.mark.parametrize("paper", COUNTS)
def test_main_claims_are_decided_by_what_is_ruled_on(paper: str) -> None:
    known = {*claims(paper), *(statement.id for statement in statements(paper))}
    decided = {name.split(" / ")[0] for main in main_claims(paper) for name in main.decided}
    assert decided <= known
    assert len(main_claims(paper)) >= 3
