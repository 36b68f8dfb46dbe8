"""Trajectory optimisation with the path between the waypoints free."""
