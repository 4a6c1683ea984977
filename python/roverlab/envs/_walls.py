"""The true distance from the walls of a scene."""

from __future__ import annotations

import math

from ..sim import Scene

_THICKNESS = 0.01


class Walls:
    """The walls of a scene, for the nearest one to a place."""

    def __init__(self, scene: Scene) -> None:
        walls = scene.walls
        self._start = walls[:, :2]
        self._along = walls[:, 2:] - walls[:, :2]
        self._squares = (self._along**2).sum(axis=1)

    def nearest(self, place: tuple[float, float]) -> tuple[float, tuple[float, float]]:
        """Distance from the surface of the nearest wall (m), and the unit vector towards it."""
        to_start = self._start - place
        part = (-(to_start * self._along).sum(axis=1) / self._squares).clip(0.0, 1.0)
        to_wall = to_start + part[:, None] * self._along
        squares = (to_wall**2).sum(axis=1)
        index = int(squares.argmin())
        distance = math.sqrt(squares[index])
        if distance == 0.0:
            return 0.0, (1.0, 0.0)
        x, y = to_wall[index] / distance
        return max(0.0, distance - _THICKNESS / 2), (float(x), float(y))
