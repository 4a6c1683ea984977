"""Following the wall of a random room."""

from __future__ import annotations

import gymnasium
import numpy as np

from ..drive import WallFollower
from ..sim import Scene
from ._base import FARTHEST, Action, Observation, RobotEnvironment
from ._walls import Walls


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
    period : float
        Duration of a step (s).
    """

    DISTANCE = 0.2
    """Distance to keep from the wall (m)."""
    TOLERANCE = 0.1
    """Error of the distance at which no reward is left (m)."""

    def __init__(self, render_mode: str | None = None, noise: float = 1.0, period: float = 0.05) -> None:
        super().__init__(render_mode, noise, period)
        self._low = np.array([0.0, 0.0, 0.0, -2.0, -20.0], np.float32)
        self._high = np.array([FARTHEST, FARTHEST, FARTHEST, 2.0, 20.0], np.float32)
        self.observation_space = gymnasium.spaces.Box(self._low, self._high)

    def baseline(self) -> WallPolicy:
        """The library's PID controller on the left distance sensor."""
        return WallPolicy(self)

    def _draw_scene(self, seed: int) -> Scene:
        return Scene.room(seed, self.DISTANCE)

    def _begin(self) -> None:
        self._walls = Walls(self.scene)
        self._place = self.simulation.truth.pose()[:2]

    def _observe(self) -> Observation:
        robot = self.robot
        ranges = [robot.distance(name) for name in ("front", "left", "right")]
        seen = np.array([*np.minimum(ranges, FARTHEST), *robot.speed()], np.float32)
        return np.clip(seen, self._low, self._high)

    def _judge(self) -> tuple[float, bool]:
        if self.simulation.truth.contacts():
            return -1.0, True
        before, self._place = self._place, self.simulation.truth.pose()[:2]
        distance, (nx, ny) = self._walls.nearest(self._place)
        weight = max(0.0, 1.0 - abs(distance - self.DISTANCE) / self.TOLERANCE)
        along = (self._place[0] - before[0]) * ny - (self._place[1] - before[1]) * nx
        return along * weight, False


class WallPolicy:
    """A policy that is the library's wall follower on the robot of an environment."""

    def __init__(self, environment: WallFollowing) -> None:
        self._environment = environment
        self._follower = WallFollower("left", environment.DISTANCE)

    def __call__(self, observation: Observation) -> Action:
        """The action for now; the robot's own sensors are read, not the observation."""
        return np.array(self._follower.decide(self._environment.robot), np.float32)
