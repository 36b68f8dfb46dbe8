"""Results keyed by content and code, kept in one SQLite file."""
