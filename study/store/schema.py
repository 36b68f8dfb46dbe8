"""The tables of the results file, and how a file of an older layout becomes one of this."""

from __future__ import annotations

import sqlite3

SCHEMA_VERSION = 2
APPLICATION_ID = 0x74_6F_73_31  # "tos1": tells our files from other SQLite files

SCHEMA_1 = """
CREATE TABLE results (
  key TEXT PRIMARY KEY, case_name TEXT NOT NULL, planner TEXT NOT NULL, settings TEXT NOT NULL, seed INTEGER NOT NULL,
  version TEXT NOT NULL, status TEXT NOT NULL, feasible INTEGER NOT NULL, duration REAL, worst_ratio REAL,
  evaluations INTEGER NOT NULL, digest TEXT NOT NULL, wall_time REAL NOT NULL, times TEXT NOT NULL
) WITHOUT ROWID;
CREATE TABLE payloads (key TEXT PRIMARY KEY REFERENCES results, document TEXT NOT NULL, arrays BLOB NOT NULL);
CREATE TABLE lineup (
  position INTEGER PRIMARY KEY, case_name TEXT NOT NULL, planner TEXT NOT NULL, label TEXT NOT NULL,
  settings TEXT NOT NULL, source TEXT NOT NULL
);
"""
"""Layout 1, kept to test the way from it."""

# Keys are random, so tables in the order of keys would be written all over the file at once. Here both tables grow at
# their end and only an index of keys is scattered; the second index answers tables of a sweep without reading the rows.
SCHEMA_2 = """
CREATE TABLE results (
  id INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE, case_name TEXT NOT NULL, label TEXT NOT NULL, planner TEXT NOT NULL,
  settings TEXT NOT NULL, seed INTEGER NOT NULL, version TEXT NOT NULL, status TEXT NOT NULL, feasible INTEGER NOT NULL,
  duration REAL, worst_ratio REAL, evaluations INTEGER NOT NULL, digest TEXT NOT NULL, wall_time REAL NOT NULL,
  times TEXT NOT NULL
);
CREATE TABLE payloads (id INTEGER PRIMARY KEY REFERENCES results, document TEXT NOT NULL, arrays BLOB NOT NULL);
CREATE INDEX results_by_label ON results (case_name, label, feasible, duration, evaluations, wall_time, status);
"""
LINEUP = SCHEMA_1[SCHEMA_1.index("CREATE TABLE lineup") :]

FROM_1_RENAME = """
ALTER TABLE results RENAME TO old_results;
ALTER TABLE payloads RENAME TO old_payloads;
"""
FROM_1_MOVE = """
INSERT INTO results SELECT NULL, key, case_name, coalesce((SELECT label FROM lineup WHERE lineup.case_name =
  old_results.case_name AND lineup.planner = old_results.planner AND lineup.settings = old_results.settings), planner),
  planner, settings, seed, version, status, feasible, duration, worst_ratio, evaluations, digest, wall_time, times
  FROM old_results ORDER BY key;
INSERT INTO payloads SELECT id, document, arrays FROM results JOIN old_payloads USING (key) ORDER BY id;
DROP TABLE old_payloads;
DROP TABLE old_results;
"""

MIGRATIONS = {1: FROM_1_RENAME + SCHEMA_2 + FROM_1_MOVE}
"""Layout by layout, what makes a file the next one; every number and every checksum stays as it is."""


def lay_out(connection: sqlite3.Connection) -> None:
    """Bring a file to this layout, an empty one or an older one, all of the way or, whatever happens, not at all."""
    layout = connection.execute("PRAGMA user_version").fetchone()[0]
    if layout == SCHEMA_VERSION:
        return
    steps = [MIGRATIONS[number] for number in range(layout, SCHEMA_VERSION)] if layout else [SCHEMA_2, LINEUP]
    marks = f"PRAGMA application_id = {APPLICATION_ID}; PRAGMA user_version = {SCHEMA_VERSION};"
    connection.executescript("\n".join(("BEGIN IMMEDIATE;", *steps, marks, "COMMIT;")))
