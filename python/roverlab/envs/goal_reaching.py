"""Reaching a goal among unknown obstacles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..nav import Bug
from ..sim import Scene
from ._base import BehaviourPolicy, RobotEnvironment
from ._task import FARTHEST, Bools, Floats, Task, require_beams, sectors, turned

_SECTORS = 36
_BEAMS = 360


class _GoalTask(Task):
    LOW = (0.0, -np.pi, -2.0, -20.0, *[0.0] * _SECTORS)
    HIGH = (100.0, np.pi, 2.0, 20.0, *[FARTHEST] * _SECTORS)
    SCAN = True

    def draw(self, seed: int) -> Scene:
        return Scene.course(seed)

    def _prepare(self, worlds: int) -> None:
        super()._prepare(worlds)
        require_beams(self.ranges, _BEAMS)
        self._goals, self._distances = np.zeros((worlds, 2)), np.zeros(worlds)
        self.local_goals = np.zeros((worlds, 2))

    def begin(self, world: int) -> None:
        goal = self.scenes[world].goal
        if goal is None:
            raise ValueError("the scene has no goal; expected one whose goal is set")
        self._goals[world] = goal
        x, y, heading = self.true_poses[world]
        dx, dy = goal[0] - x, goal[1] - y
        cos, sin = np.cos(heading), np.sin(heading)
        self.local_goals[world] = (cos * dx + sin * dy, cos * dy - sin * dx)
        self._distances[world] = np.hypot(dx, dy)

    def judge(self) -> tuple[Floats, Bools]:
        away = self._goals - self.true_poses[:, :2]
        distances = np.hypot(away[:, 0], away[:, 1])
        reached, touched = distances < GoalReaching.REACHED, self.contacts > 0
        rewards = self._distances - distances + 10.0 * reached
        self._distances[:] = distances
        rewards[touched] = -1.0
        return rewards, reached | touched

    def observe(self, out: NDArray[np.float32]) -> None:
        away = self.local_goals - self.poses[:, :2]
        out[:, 0] = np.hypot(away[:, 0], away[:, 1])
        out[:, 1] = turned(np.arctan2(away[:, 1], away[:, 0]) - self.poses[:, 2])
        out[:, 2:4] = self.speeds
        out[:, 4:] = sectors(self.ranges, _SECTORS)
        self.bound(out)


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
    period : float, optional
        Duration of a step, otherwise 0.1 (s).
    """

    TASK = _GoalTask
    SECTORS = _SECTORS
    """Number of sectors of a scan."""
    REACHED = 0.1
    """Distance from the goal that counts as reached (m)."""

    def baseline(self) -> BehaviourPolicy:
        """The library's DistBug."""
        return BehaviourPolicy(self, Bug(self.goal()))

    def goal(self) -> tuple[float, float]:
        """The goal relative to the robot's start: ahead and to the left (m)."""
        assert isinstance(self.task, _GoalTask)
        ahead, left = self.task.local_goals[0].tolist()
        return ahead, left
