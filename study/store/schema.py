"""Tables of the results file: the definitions that a file must have, to the letter, to be ours."""

from __future__ import annotations

import sqlite3

SCHEMA_VERSION = 3
APPLICATION_ID = 0x74_6F_73_31  # "tos1": tells our files from other SQLite files

# Keys are random, so tables in the order of keys would be written all over the file at once. Here the tables grow at
# their end and only an index of keys is scattered; the second index answers tables of a sweep without reading the rows.
_TEXTS = ("key", "kind", "subject", "label", "method", "settings", "code", "status", "digest", "times", "seal")
_KINDS = " AND ".join(
    [
        *(f"typeof({name}) = 'text'" for name in _TEXTS),
        "typeof(seed) = 'integer' AND typeof(evaluations) = 'integer' AND feasible IN (0, 1)",
        "typeof(wall_time) = 'real' AND typeof(duration) IN ('real', 'null')",
        "typeof(worst_ratio) IN ('real', 'null')",
    ]
)
WRONG_KIND = f"SELECT id FROM results WHERE NOT ({_KINDS}) LIMIT 1"  # noqa: S608
"""Query for a row with a text where a number belongs, or the like; SQLite itself does not mind."""

DEFINITIONS = {
    "results": (
        "CREATE TABLE results (id INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE, kind TEXT NOT NULL, "
        "subject TEXT NOT NULL, label TEXT NOT NULL, method TEXT NOT NULL, settings TEXT NOT NULL, "
        "seed INTEGER NOT NULL, code TEXT NOT NULL, status TEXT NOT NULL, feasible INTEGER NOT NULL, duration REAL, "
        "worst_ratio REAL, evaluations INTEGER NOT NULL, digest TEXT NOT NULL, wall_time REAL NOT NULL, "
        "times TEXT NOT NULL, seal TEXT NOT NULL)"
    ),
    "payloads": (
        "CREATE TABLE payloads (id INTEGER PRIMARY KEY REFERENCES results, document TEXT NOT NULL, arrays BLOB NOT NULL)"
    ),
    "notes": "CREATE TABLE notes (name TEXT PRIMARY KEY, text TEXT NOT NULL, seal TEXT NOT NULL)",
    "results_by_label": (
        "CREATE INDEX results_by_label ON results "
        "(kind, subject, label, feasible, duration, evaluations, wall_time, status)"
    ),
}
"""By name what SQLite notes of every table and index of ours."""


def lay_out(connection: sqlite3.Connection) -> None:
    """Make the tables of an empty file, all of them or, whatever happens, none."""
    if connection.execute("PRAGMA user_version").fetchone()[0] == SCHEMA_VERSION:
        return
    marks = f"PRAGMA application_id = {APPLICATION_ID}; PRAGMA user_version = {SCHEMA_VERSION};"
    connection.executescript(
        "\n".join(("BEGIN IMMEDIATE;", *(f"{text};" for text in DEFINITIONS.values()), marks, "COMMIT;"))
    )


def strangers(connection: sqlite3.Connection) -> list[str]:
    """Name what a file holds beside our own tables, and those of ours that are missing or defined otherwise."""
    rows = connection.execute("SELECT name, sql FROM sqlite_master WHERE name NOT LIKE 'sqlite_autoindex_%'").fetchall()
    held = dict(rows)
    odd = [str(name) for name, sql in rows if DEFINITIONS.get(name) != sql]
    return odd + [name for name in DEFINITIONS if name not in held]
