"""Pathfinding among boxes: the RRT of the PUMA560 paper, stronger references, and collision checks of a whole arm."""
