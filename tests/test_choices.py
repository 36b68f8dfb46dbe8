"""Named options: texts become members, and unknown texts are refused with a hint."""

import dataclasses

import pytest

from study import StudyError
from study.choices import Choice, Options


class GripperState(Choice):
    OPEN = "open"
    HALF_SHUT = "half-shut"


@dataclasses.dataclass(frozen=True)
class Gripper(Options):
    state: GripperState = GripperState.OPEN
    name: str = "gripper"


def test_the_fields_of_a_dataclass_take_texts_and_keep_members():
    assert Gripper("half-shut").state is GripperState.HALF_SHUT
    assert Gripper("open") == Gripper()
    assert Gripper("open", "open").name == "open"  # only what is a choice becomes one


def test_an_unknown_text_is_refused_by_the_enumerations_name_in_plain_words():
    with pytest.raises(StudyError, match="no gripper state 'half shut'; did you mean 'half-shut'"):
        Gripper("half shut")
