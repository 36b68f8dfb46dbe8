"""Nonlinear programs over segment durations on a given curve family."""
