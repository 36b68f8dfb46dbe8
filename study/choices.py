"""Named options: enumerations of strings, as files and the command line write them."""

from __future__ import annotations

import re
from enum import StrEnum

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
        raise unknown(kind, str(value), [str(member) for member in cls])


def convert(options: object, **kinds: type[Choice]) -> None:
    """Turn the texts among a frozen dataclass's fields into members of their enumerations.

    Parameters
    ----------
    options : dataclass instance
        To be called from its `__post_init__`.
    **kinds : enumeration for each field

    Raises
    ------
    StudyError
        If a text is not a member.
    """
    for field, kind in kinds.items():
        object.__setattr__(options, field, kind(getattr(options, field)))
