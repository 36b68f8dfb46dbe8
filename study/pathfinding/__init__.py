"""Paths around boxes: the RRT of the PUMA560 paper, its honest references, and collision checks of a whole arm."""
