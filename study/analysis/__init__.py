"""Summaries of what every method achieved, computed once for terminal, report and recording."""
