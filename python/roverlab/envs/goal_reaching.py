"""Reaching a goal among unknown obstacles."""

from __future__ import annotations

import math

import gymnasium
import numpy as np

from ..nav import Bug
from ..sim import Scene
from ._base import FARTHEST, Action, Observation, RobotEnvironment


class GoalReaching(RobotEnvironment):
    """Drive to a goal on a random field of obstacles, without touching them.

    Each episode has another walled field of 4 to 6 m with three to eight obstacles, many of them concave, and a goal
    that can be reached.

    Observation
        Distance of the goal (m), its bearing from straight ahead (rad), both by odometry, linear speed (m/s), angular
        speed (rad/s), and the nearest range in each of 36 sectors of 10 degrees (m, 10 without a return),
        counter-clockwise from behind.
    Action
        Linear speed, 0 to 0.3 m/s, and angular speed, -2 to 2 rad/s.
    Reward
        By how much the true distance from the goal has decreased (m), and 10 within 0.1 m of it, which ends the
        episode. A contact costs 1 and ends it too.

    Parameters
    ----------
    render_mode : {None, "svg"}
        With ``svg``, `render` returns a picture as text.
    noise : float
        Errors of drives and sensors as a multiple of those of the real robot.
    period : float
        Duration of a step (s).
    """

    SECTORS = 36
    """Number of sectors of a scan."""
    REACHED = 0.1
    """Distance from the goal that counts as reached (m)."""

    def __init__(self, render_mode: str | None = None, noise: float = 1.0, period: float = 0.1) -> None:
        super().__init__(render_mode, noise, period)
        self._low = np.array([0.0, -math.pi, -2.0, -20.0, *[0.0] * self.SECTORS], np.float32)
        self._high = np.array([100.0, math.pi, 2.0, 20.0, *[FARTHEST] * self.SECTORS], np.float32)
        self.observation_space = gymnasium.spaces.Box(self._low, self._high)
        self._scan = np.empty(360)

    def baseline(self) -> BugPolicy:
        """The library's DistBug."""
        return BugPolicy(self)

    def goal(self) -> tuple[float, float]:
        """The goal relative to the robot's start: ahead and to the left (m)."""
        return self._goal

    def _draw_scene(self, seed: int) -> Scene:
        return Scene.course(seed)

    def _begin(self) -> None:
        if self.scene.goal is None:
            raise ValueError("the scene has no goal; expected one whose goal is set")
        if len(self.robot.beam_angles()) != len(self._scan):
            raise ValueError(f"the robot's lidar has {len(self.robot.beam_angles())} beams; expected 360")
        x, y, heading = self.simulation.truth.pose()
        dx, dy = self.scene.goal[0] - x, self.scene.goal[1] - y
        cos, sin = math.cos(heading), math.sin(heading)
        self._goal = (cos * dx + sin * dy, cos * dy - sin * dx)
        self._distance = math.hypot(dx, dy)

    def _observe(self) -> Observation:
        x, y, heading = self.robot.pose()
        dx, dy = self._goal[0] - x, self._goal[1] - y
        bearing = math.remainder(math.atan2(dy, dx) - heading, math.tau)
        sectors = self.robot.scan(self._scan).reshape(self.SECTORS, -1).min(axis=1)
        seen = np.array([math.hypot(dx, dy), bearing, *self.robot.speed(), *sectors], np.float32)
        return np.clip(seen, self._low, self._high)

    def _judge(self) -> tuple[float, bool]:
        if self.simulation.truth.contacts():
            return -1.0, True
        x, y, _ = self.simulation.truth.pose()
        assert self.scene.goal is not None
        before, self._distance = self._distance, math.hypot(self.scene.goal[0] - x, self.scene.goal[1] - y)
        reached = self._distance < self.REACHED
        return before - self._distance + (10.0 if reached else 0.0), reached


class BugPolicy:
    """A policy that is the library's DistBug on the robot of an environment."""

    def __init__(self, environment: GoalReaching) -> None:
        self._environment = environment
        self._bug = Bug(environment.goal())

    def __call__(self, observation: Observation) -> Action:
        """The action for now; the robot's own sensors are read, not the observation."""
        return np.array(self._bug.decide(self._environment.robot), np.float32)
