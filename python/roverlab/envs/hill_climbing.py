"""Climbing random hills."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..drive import Ascent
from ..sim import RobotSpec, Scene
from ._base import BehaviourPolicy, RobotEnvironment
from ._task import FARTHEST, Bools, Floats, Task, require_sensors

_DOWN = 8
"""Number of distance sensors that look down."""
_SPEC = RobotSpec("Blizzard").with_slope_sensors()


class _HillTask(Task):
    LOW = (*[0.0] * _DOWN, -np.pi, -np.pi, -2.0, -20.0)
    HIGH = (*[FARTHEST] * _DOWN, np.pi, np.pi, 2.0, 20.0)
    SLOWEST = (0.0, -1.0)
    FASTEST = (0.2, 1.0)
    SPACE = True

    def draw(self, seed: int) -> Scene:
        return Scene.hills(seed)

    def place(self, scene: Scene) -> None:
        if not scene.robots:
            scene.add_robot(_SPEC)

    def _prepare(self, worlds: int) -> None:
        super()._prepare(worlds)
        require_sensors(self.distances, _DOWN)
        self._down = self.distances[:, -_DOWN:]
        self._attitudes, self._heights, self._lost = self.space[:, :2], self.space[:, 7], self.space[:, 8]
        self._before = np.zeros(worlds)

    def begin(self, world: int) -> None:
        self._before[world] = self._heights[world]

    def judge(self) -> tuple[Floats, Bools]:
        rewards = self._heights - self._before
        self._before[:] = self._heights
        over: Bools = self._lost > 0.0
        rewards[over] = -HillClimbing.COST
        return rewards, over

    def observe(self, out: NDArray[np.float32]) -> None:
        out[:, :_DOWN] = self._down
        out[:, _DOWN : _DOWN + 2] = self._attitudes
        out[:, _DOWN + 2 :] = self.speeds
        self.bound(out)


class HillClimbing(RobotEnvironment):
    """Drive a tracked robot up unknown hills, as high as possible, without falling.

    Each episode has other hills and mesas of up to 0.5 m on a square of 5 m, some of them too steep for the robot. The
    Blizzard begins on gentle ground near the border. The tracks slip on slopes; on steep ones it slides or tips, and
    beyond the border it falls.

    Observation
        Distances that eight sensors at the robot's top measure to the ground, counter-clockwise from ahead, each
        outwards and down by 45 degrees (m, 10 without a return), roll and pitch by the inertial unit (rad; a positive
        pitch lowers the nose), linear speed (m/s) and angular speed (rad/s) by the tracks.
    Action
        Linear speed, 0 to 0.2 m/s, and angular speed, -1 to 1 rad/s.
    Reward
        Gain in true height (m). A robot that tips or falls loses 1, which ends the episode.

    Parameters
    ----------
    render_mode : {None, "svg"}
        With ``svg``, `render` returns a picture as text.
    noise : float
        Errors of drives and sensors as a multiple of those of the real robot.
    period : float, optional
        Duration of a step, otherwise 0.1 (s).
    """

    TASK = _HillTask
    COST = 1.0
    """Cost of tipping and falling."""

    def baseline(self) -> BehaviourPolicy:
        """The library's steepest ascent, which ends on a local maximum."""
        return BehaviourPolicy(self, Ascent(_SPEC))
