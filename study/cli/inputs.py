"""What the commands take as a problem: a case, or waypoints alone with limits from other files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from study.cases.library import Case, load_case, own_case
from study.cases.own_case import bare_content
from study.errors import StudyError
from study.io.joint_trajectory import found_message
from study.io.table import parsed

FORMS = (".yaml", ".yml", ".json")
TABLES = (".csv", ".tsv", ".txt")

LimitFiles = Annotated[
    list[Path] | None,
    typer.Option("--limits", help="For waypoints alone: MoveIt joint_limits.yaml or URDF; may be given twice."),
]


def load_any(file: Path, units: str | None = None, limits: Sequence[Path] = ()) -> Case:
    """Load a case, or waypoints alone with limits from other files; a name of the study's own cases will do too."""
    if is_bare(file):
        return own_case(bare_content(file, units, limits), file)
    if limits or units:
        raise StudyError(
            f"--limits and --units go with a file of waypoints alone; {str(file)!r} is a case, which says both itself"
        )
    return load_case(file if file.suffix else str(file))


def is_bare(file: Path) -> bool:
    """Whether a file holds waypoints and nothing else."""
    if file.suffix.lower() in TABLES:
        return True
    if file.suffix.lower() not in FORMS or not file.exists():
        return False
    content = parsed(file)
    return isinstance(content, list) or found_message(content) is not None
