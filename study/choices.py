"""Named options: enumerations of strings, as files and the command line write them."""

from __future__ import annotations

import re
from enum import StrEnum
from functools import cache
from typing import get_type_hints

from study.arrays import of_kind
from study.errors import unknown


class Choice(StrEnum):
    """Enumeration whose members can be looked up by their text; `Formulation("scaled")` is `Formulation.SCALED`."""

    @classmethod
    def _missing_(cls, value: object) -> None:
        """Refuse a name that the enumeration does not have.

        Raises
        ------
        StudyError
            Naming the kind of option and its known names.
        """
        kind = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", cls.__name__).lower()
        raise unknown(kind, value, [str(member) for member in cls])


class Options:
    """Base of dataclasses whose options are choices: a text in the place of a choice becomes its member.

    Raises
    ------
    StudyError
        If a text is not a member.
    """

    def __post_init__(self) -> None:
        own: type = self.__class__
        for name, kind in _choices(own).items():
            object.__setattr__(self, name, kind(of_kind(getattr(self, name), str, name)))


@cache
def _choices(options: type) -> dict[str, type[Choice]]:
    kinds = get_type_hints(options).items()
    return {name: kind for name, kind in kinds if isinstance(kind, type) and issubclass(kind, Choice)}
