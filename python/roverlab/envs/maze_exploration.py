"""Exploring a random maze."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..drive import WallFollower
from ..maze import Maze
from ..sim import Scene
from ._base import BehaviourPolicy, RobotEnvironment
from ._task import FARTHEST, Bools, Floats, Task, require_sensors

_SIDE = 5
_CELL = 0.4
_MOST = 32
"""Largest number of rows and of columns of a maze."""


def _cells(scene: Scene) -> tuple[int, int]:
    """Numbers of columns and rows of a scene."""
    x0, y0, x1, y1 = scene.bounds
    columns, rows = round(x1 / _CELL), round(y1 / _CELL)
    if not (1 <= columns <= _MOST and 1 <= rows <= _MOST and x0 > -_CELL and y0 > -_CELL):
        expected = f"cells of {_CELL} m from (0, 0) on, at most {_MOST} in a row"
        raise ValueError(f"the scene's bounds are {(x0, y0, x1, y1)}; expected {expected}")
    return columns, rows


class _MazeTask(Task):
    LOW = (0.0, 0.0, 0.0, 0.0, -2.0, -20.0, 0.0, 0.0, 0.0, 0.0)
    HIGH = (FARTHEST, FARTHEST, FARTHEST, FARTHEST, 2.0, 20.0, 1.0, 1.0, 1.0, 1.0)

    def draw(self, seed: int) -> Scene:
        return Maze.braided(_SIDE, _SIDE, 0.0, seed).to_scene(_CELL)

    def _prepare(self, worlds: int) -> None:
        super()._prepare(worlds)
        require_sensors(self.distances, 4)
        # No larger than it has to be, so that it stays in the cache, and with a border of cells all round, so that
        # those of the outer ones have neighbours too.
        width = max(_SIDE, *(max(_cells(scene)) for scene in self.scenes)) + 2
        self._visited = np.zeros((worlds, width, width), np.bool_)
        # Steps in the array to the next column and row, and to the cell ahead and on, counter-clockwise, for a robot
        # that looks east and on.
        self._steps = np.array([1.0, width])
        self._around = np.array([np.roll((1, width, -1, -width), -quarter) for quarter in range(4)])
        self._flat = self._visited.reshape(-1)
        # The cell at the origin of each world.
        self._first = np.arange(worlds) * width**2 + width + 1
        self._at = self._first.copy()
        self._places = np.zeros((worlds, 2))
        self._left = np.zeros(worlds, np.int64)

    def begin(self, world: int) -> None:
        columns, rows = _cells(self.scenes[world])
        self._visited[world] = True
        self._visited[world, 1 : rows + 1, 1 : columns + 1] = False
        self._left[world] = rows * columns
        self._visit(slice(world, world + 1))

    def _visit(self, worlds: slice) -> Bools:
        """Marks the cells of robots. Returns which of them are new."""
        places = self._places[worlds]
        np.multiply(self.true_poses[worlds, :2], 1.0 / _CELL, out=places)
        np.clip(places, 0.0, self._visited.shape[1] - 3.0, out=places)
        np.floor(places, out=places)
        at = self._first[worlds] + (places @ self._steps).astype(np.int64)
        new: Bools = ~self._flat[at]
        self._flat[at] = True
        self._left[worlds] -= new
        self._at[worlds] = at
        return new

    def judge(self) -> tuple[Floats, Bools]:
        rewards = self._visit(slice(None)).astype(np.float64)
        done, touched = self._left == 0, self.contacts > 0
        over = done | touched
        if over.any():
            rewards[done] += MazeExploration.BONUS
            rewards[touched] = -1.0
        return rewards, over

    def observe(self, out: NDArray[np.float32]) -> None:
        out[:, :4] = self.distances[:, :4]
        out[:, 4:6] = self.speeds
        quarters = np.rint(self.true_poses[:, 2] * (2.0 / np.pi)).astype(np.int64) & 3
        around = self._around.take(quarters, axis=0)
        around += self._at[:, None]
        out[:, 6:] = self._flat.take(around)
        self.bound(out)


class MazeExploration(RobotEnvironment):
    """Visit all cells of a random maze of 5 x 5 cells of 0.4 m, without touching a wall.

    Each episode has another maze without loops. The robot begins in a corner.

    Observation
        Distances ahead, to the left, to the right and behind (m, 10 without a return), linear speed (m/s), angular
        speed (rad/s), and for the cells ahead, to the left, behind and to the right whether they have been visited or
        are outside the maze (0 or 1). Walls do not count for these: the robot may not be able to go there.
    Action
        Linear speed, 0 to 0.3 m/s, and angular speed, -2 to 2 rad/s.
    Reward
        1 for each cell that is entered for the first time, and 10 more for the last one, which ends the episode. A
        contact costs 1 and ends it too.

    Parameters
    ----------
    render_mode : {None, "svg"}
        With ``svg``, `render` returns a picture as text.
    noise : float
        Errors of drives and sensors as a multiple of those of the real robot.
    period : float, optional
        Duration of a step, otherwise 0.05 (s).
    """

    TASK = _MazeTask
    PERIOD = 0.05
    CELL = _CELL
    """Size of a cell (m)."""
    BONUS = 10.0
    """Reward of the last cell."""

    def baseline(self) -> BehaviourPolicy:
        """The library's wall follower, in the middle of the corridors."""
        return BehaviourPolicy(self, WallFollower("left", 0.467 * self.CELL))
