"""Plans on a numpy array: cell by cell, in any direction, and by the costs of cells."""

import numpy as np

from roverlab.nav import Planner, distance_field, inflate

# A building of 1024 x 1024 cells: walls every 64 cells, each with doors.
free = np.ones((1024, 1024), dtype=bool)
free[64::64] = False
free[:, 64::64] = False
random = np.random.default_rng(1)
for wall in range(64, 1024, 64):
    for door in random.integers(2, 50, 16) + 64 * np.arange(16):
        free[wall, door : door + 12] = True
        free[door : door + 12, wall] = True

robot = inflate(free, radius=3.0)
start, goal = (20, 20), (1000, 1000)
for method in ("astar", "jps", "any_angle"):
    path = Planner(robot, method).plan(start, goal)
    print(f"{method:>9}: {path.cost:7.1f} cells, {path.expanded:6} nodes expanded")

# Cells near walls cost more, so that the path keeps to the middle of rooms and doors.
distance = distance_field(free)
costs = np.where(robot, 1.0 + 20.0 / (1.0 + distance), np.inf)
careful = Planner(costs).plan(start, goal)
shortest = Planner(robot).plan(start, goal)


def room(points: np.ndarray) -> float:
    """Mean distance from the walls along a path."""
    cells = points.astype(int)
    return float(distance[cells[:, 0], cells[:, 1]].mean())


print(f"distance from walls: {room(shortest.points):.1f} cells shortest, {room(careful.points):.1f} careful")
assert room(careful.points) > room(shortest.points)
