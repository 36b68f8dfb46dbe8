"""Valid files made invalid in ways that know their structure: bytes, tokens, values, keys, depth, encodings, arrays."""

from __future__ import annotations

import copy
import io
import json
import re
import zipfile
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import yaml

Pick = Callable[[int], int]
"""Draws a number from 0 to below another one."""

TOKEN = re.compile(rb"[A-Za-z_][\w.-]*|[+-]?\d[\d.eE+-]*|[ \t]+|\r?\n|.", re.DOTALL)
NUMBER = re.compile(rb"[+-]?\d[\d.eE+-]*")

SCALARS = (
    b"1e308", b"-1e308", b"1e400", b"5e-324", b"-0", b"-0.0", b"0", b"-1", b"nan", b".nan", b"NaN", b"inf", b"-.inf", b"Infinity",
    b"1" * 400, b"9" * 5000, b"0x" + b"F" * 5000, b"9223372036854775808", b"-2147483649", b"1_000", b"0x1F", b"0o17", b"12:30:45", b"1,5", b"1.5.2", b"1e",
    b"true", b"null", b"~", b"", b"''", b'""', b"'nan'", b"2020-01-01", b"2020-01-01T00:00:00Z", b"[]", b"{}", b"[[]]", b"[[[1]]]",
    b'"\\ud800"', b'"\\u0000"', b'"\\e]0;x\\a"', b"\xed\xa0\x80", b"\xff", b"\x00", b"\x1b[31m", "\u202e\u00b2\u0663\u2028".encode(), b"=1+1",
    b"/dev/zero", b"../../..", b"x" * 5000, b"!!binary aGk=", b"!!set {a, b}", b"!!omap [a: 1]", b"!!python/name:os.system", b"!degrees x",
    b"!!float x", b"!!float ''", b"!!int +", b"!!bool maybe", b"!!int 0b2", b"!!timestamp x", b"&a [*a]", b"&b 1", b"*b", b"<<: {a: 1}", b"? [a]", b"? {a: b} : c", b"---", b"...", b"%YAML 9.9", b"# ",
)  # fmt: skip
VALUES = (
    1e308, -1e308, 5e-324, -0.0, float("nan"), float("inf"), 0, -1, 1, 2, 7, 1e-9, 10**400, 2**63, 2**31, True, False, None, "", "nan",
    "1", "\ud800", "\x00", "\x1b]0;x\x07", "=1+1", "a\nb", "/dev/zero", ".", "x" * 300, [], {}, [[]], [None], [[1]], [1, "a"], {"": 0},
    {"a": {"b": []}}, [1e308, -1e308], [True], "free", "rest", "rad", "deg", "smooth", [0.0] * 50, [[0.0, 1.0]] * 3,
)  # fmt: skip
ENCODINGS = ("utf-16", "utf-16-be", "utf-32", "utf-7", "utf-8-sig", "cp1252", "shift_jis", "cp037")


def number(pick: Pick) -> bytes:
    """A number of any size in any notation."""
    digits, exponent = pick(10**6), pick(640) - 320
    return (b"%d" % digits, b"%de%d" % (digits, exponent), b"-0.%d" % digits, b"%d.%d" % (exponent, digits))[pick(4)]


def in_bytes(content: bytes, pick: Pick) -> bytes:
    """Flip, cut, double or fill in some bytes."""
    if not content:
        return SCALARS[pick(len(SCALARS))]
    at, length = pick(len(content)), 1 + min(pick(64), pick(64))
    return (
        content[:at] + bytes([content[at] ^ 1 << pick(8)]) + content[at + 1 :],
        content[:at] + content[at + length :],
        content[:at],
        content[:at] + content[at : at + length] * (1 + pick(20)) + content[at + length :],
        content[:at] + bytes([pick(256)]) * length + content[at + length :],
        content[:at] + pick(2**32).to_bytes(4, "little") + content[at + 4 :],
    )[pick(6)]


def in_tokens(content: bytes, pick: Pick) -> bytes:
    """Replace, drop, double, swap or nest tokens; half of the time numbers."""
    tokens = TOKEN.findall(content)
    numbers = [k for k, token in enumerate(tokens) if NUMBER.fullmatch(token)]
    if not tokens:
        return SCALARS[pick(len(SCALARS))]
    at = numbers[pick(len(numbers))] if numbers and pick(2) else pick(len(tokens))
    other, deep = pick(len(tokens)), (3, 99, 101, 5000)[pick(4)]
    changed: tuple[list[bytes], ...] = (
        [*tokens[:at], SCALARS[pick(len(SCALARS))], *tokens[at + 1 :]],
        [*tokens[:at], number(pick), *tokens[at + 1 :]],
        [*tokens[:at], tokens[other], *tokens[at + 1 :]],
        tokens[:at] + tokens[at + 1 + pick(4) :],
        tokens[:at] + tokens[at : at + 1 + pick(12)] * 2 + tokens[at:],
        [*tokens[:at], (b"[", b"{a: ", b'{"a":', b"<a>", b"- ")[pick(5)] * deep, *tokens[at:]],
    )
    return b"".join(changed[pick(len(changed))])


def in_lines(content: bytes, pick: Pick) -> bytes:
    """Drop, double, swap, indent or part lines."""
    lines = content.splitlines(keepends=True) or [b""]
    at, other = pick(len(lines)), pick(len(lines))
    swapped = list(lines)
    swapped[at], swapped[other] = swapped[other], swapped[at]
    return b"".join(
        (
            lines[:at] + lines[at + 1 :],
            [*lines[:at], lines[at] * (2 + pick(3)), *lines[at + 1 :]],
            swapped,
            [*lines[:at], b"  " + lines[at], *lines[at + 1 :]],
            [*lines[:at], (b"\r", b"\x85", b"\xe2\x80\xa8", b"\n\n", b"---\n", b"\x0c")[pick(6)], *lines[at:]],
        )[pick(5)]
    )


def in_encoding(content: bytes, pick: Pick) -> bytes:
    """Write text in another encoding."""
    return content.decode("utf-8", "replace").encode(ENCODINGS[pick(len(ENCODINGS))], "replace")


def in_tree(content: bytes, pick: Pick) -> bytes:
    """Change one value of a document in YAML or JSON and write it as either."""
    try:
        tree = copy.deepcopy(yaml.load(content, getattr(yaml, "CSafeLoader", yaml.SafeLoader)))
        places = list(_places(tree))
        if not places:
            return in_tokens(content, pick)
        parent, key = places[pick(len(places))]
        _change(parent, key, places, pick)
        if pick(2):
            return json.dumps(tree).encode()
        return yaml.safe_dump(tree, allow_unicode=bool(pick(2)), default_flow_style=bool(pick(2))).encode(
            "utf-8", "surrogatepass"
        )
    except Exception:  # what the packages make of spoilt text
        return in_tokens(content, pick)


def _change(parent: Any, key: Any, places: Sequence[tuple[Any, Any]], pick: Pick) -> None:
    other, place = places[pick(len(places))]
    deep: Any = parent[key]
    for _ in range((1, 2, 98, 105)[pick(4)]):
        deep = [deep] if pick(2) else {"a": deep}
    edit = pick(6)
    if edit == 0:
        del parent[key]
    elif edit == 1:
        parent[key] = copy.deepcopy(other[place])
    elif edit == 2:
        parent[key] = deep
    elif edit == 3 and isinstance(parent, dict):
        names = [name for holder, name in places if isinstance(holder, dict)]
        parent[names[pick(len(names))]] = parent.pop(key)
    elif edit == 4 and isinstance(parent[key], list):
        parent[key] *= (2, 3, 50)[pick(3)]
    else:
        parent[key] = copy.deepcopy(VALUES[pick(len(VALUES))])


def _places(tree: Any) -> Iterator[tuple[Any, Any]]:
    if isinstance(tree, dict | list):
        for key, inner in list(tree.items() if isinstance(tree, dict) else enumerate(tree)):
            yield tree, key
            yield from _places(inner)


MANY = 10**6
"""Entries of an array that is no longer copied."""


KINDS = (
    "f8", "f4", "f2", "i1", "u8", "?", "c16", "U3", "S3", "M8[s]", "m8[ns]", "V4", ">f8", "g", [("a", "f8"), ("b", "i4")],
)  # fmt: skip
SHAPES = ((), (0,), (3,), (0, 3), (3, 0), (4, 2), (4, 3), (2, 2, 2), (1, 1), (40, 1))
FILLS = (0.0, 1.0, np.nan, np.inf, 1e308, 5e-324, -1e-300)
KEYS = ("time", "velocity", "joint_names", "coefficients", "knots", "position_coefficients", "time_coefficients")
LIES = (b"1", b"0", b"4000000000", b"-1", b"10**9")


def in_arrays(content: bytes, pick: Pick) -> bytes:
    """Put an array of another kind, shape or content into a NumPy file, or lie about it in its header."""
    arrays = _arrays_in(content)
    if not arrays:
        return in_bytes(content, pick)
    name = sorted(arrays)[pick(len(arrays))]
    key, array = (*KEYS, name)[pick(len(KEYS) + 1)], _other_array(arrays[name], pick)
    files = {key: _npy(array) for key, array in {**arrays, key if name else name: array}.items()}
    if pick(3) == 0:
        head, rest = files[name][:120], files[name][120:]
        files[name] = re.sub(rb"\d+", lambda _: LIES[pick(len(LIES))], head) + rest
    if name == "":
        return files[""]
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as file:
        for key, part in files.items():
            whole = part if pick(20) else part + bytes(10**7)
            file.writestr(zipfile.ZipInfo(f"{key}.npy"), whole, zipfile.ZIP_DEFLATED)
    return archive.getvalue()


def _arrays_in(content: bytes) -> dict[str, Any]:
    """Arrays of a NumPy file by name, one alone without a name; none where it is spoilt already, or too much to load."""
    try:
        loaded = np.load(io.BytesIO(content))
        arrays = {"": loaded} if isinstance(loaded, np.ndarray) else dict(loaded)
    except Exception:  # spoilt by an edit before this one
        return {}
    # texts of no length take no bytes, be they as many as they like
    return arrays if all(array.size < MANY for array in arrays.values()) else {}


def _other_array(array: Any, pick: Pick) -> Any:
    """The array, or one of another kind and shape, perhaps with an odd number in it."""
    shape, kind = SHAPES[pick(len(SHAPES))], KINDS[pick(len(KINDS))]
    other = array.copy() if pick(3) == 0 else np.resize(np.arange(40), shape).astype(kind)
    if other.dtype.kind == "f" and other.size and pick(2):
        with np.errstate(all="ignore"):
            other.flat[pick(other.size)] = FILLS[pick(len(FILLS))]
    return other


def _npy(array: Any) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


BYTES = (in_bytes,)
TEXT = (in_tokens, in_tokens, in_lines, in_bytes, in_encoding)
TREES = (in_tree, in_tree, in_tree, *TEXT)
ARRAYS = (in_arrays, in_arrays, in_bytes)
