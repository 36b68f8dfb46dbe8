"""Deterministic references on the same waypoints and limits; found by `study` through entry points only."""
