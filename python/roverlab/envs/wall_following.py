"""Following the wall of a random room."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..drive import WallFollower
from ..sim import Scene
from ._base import BehaviourPolicy, RobotEnvironment
from ._task import FARTHEST, Bools, Floats, Task, require_sensors


class _WallTask(Task):
    LOW = (0.0, 0.0, 0.0, -2.0, -20.0)
    HIGH = (FARTHEST, FARTHEST, FARTHEST, 2.0, 20.0)
    WALLS = True

    def draw(self, seed: int) -> Scene:
        return Scene.room(seed, WallFollowing.DISTANCE)

    def _prepare(self, worlds: int) -> None:
        super()._prepare(worlds)
        require_sensors(self.distances, 3)
        self._places = np.zeros((worlds, 2))

    def begin(self, world: int) -> None:
        self._places[world] = self.true_poses[world, :2]

    def judge(self) -> tuple[Floats, Bools]:
        moved = self.true_poses[:, :2] - self._places
        self._places[:] = self.true_poses[:, :2]
        errors = np.abs(self.walls[:, 0] - WallFollowing.DISTANCE)
        weights = np.maximum(1.0 - errors / WallFollowing.TOLERANCE, 0.0)
        rewards = (moved[:, 0] * self.walls[:, 2] - moved[:, 1] * self.walls[:, 1]) * weights
        touched = self.contacts > 0
        rewards[touched] = -1.0
        return rewards, touched

    def observe(self, out: NDArray[np.float32]) -> None:
        out[:, :3] = self.distances[:, :3]
        out[:, 3:] = self.speeds
        self.bound(out)


class WallFollowing(RobotEnvironment):
    """Follow the wall on the left at a distance of 0.2 m, without touching it.

    Each episode has another room with corners of many angles, curved walls and open doors. The robot begins
    somewhere in it.

    Observation
        Distances ahead, to the left and to the right (m, 10 without a return), linear speed (m/s) and angular
        speed (rad/s), with the noise of the real sensors.
    Action
        Linear speed, 0 to 0.3 m/s, and angular speed, -2 to 2 rad/s.
    Reward
        Way along the wall, with the wall on the left (m), times ``1 - |d - 0.2| / 0.1``, and 0 farther off, where d
        is the true distance from the wall (m). A contact costs 1 and ends the episode.

    Parameters
    ----------
    render_mode : {None, "svg"}
        With ``svg``, `render` returns a picture as text.
    noise : float
        Errors of drives and sensors as a multiple of those of the real robot.
    period : float, optional
        Duration of a step, otherwise 0.05 (s).
    """

    TASK = _WallTask
    PERIOD = 0.05
    DISTANCE = 0.2
    """Distance to keep from the wall (m)."""
    TOLERANCE = 0.1
    """Error of the distance at which no reward is left (m)."""

    def baseline(self) -> BehaviourPolicy:
        """The library's PID controller on the left distance sensor."""
        return BehaviourPolicy(self, WallFollower("left", self.DISTANCE))
