"""Following another robot."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..drive import Follower
from ..sim import Scene
from ._base import BehaviourPolicy, RobotEnvironment
from ._task import FARTHEST, Bools, Floats, Task, require_beams, sectors, turned

_SECTORS = 36
_BEAMS = 360
_HALL = (6.0, 5.0)
_RADIUS = 0.06
_LEADER = 0.22
"""Speed of the leader (m/s)."""
_NEAR = 0.25
"""Distance at which a place of the route counts as reached (m)."""
_CYCLE, _STOP = 100, 30
"""Steps from one stop to the next, and of a stop."""


class _SwarmTask(Task):
    LOW = (0.0, -np.pi, -2.0, -20.0, *[0.0] * _SECTORS)
    HIGH = (FARTHEST, np.pi, 2.0, 20.0, *[FARTHEST] * _SECTORS)
    ROBOT = 1
    SCAN = True

    def draw(self, seed: int) -> Scene:
        return Scene.walled(*_HALL)

    def place(self, scene: Scene) -> None:
        if not scene.robots:
            scene.add_robot("S4", (1.8, 1.2, 0.0))
            scene.add_robot("S4", (1.35, 1.2, 0.0))
        if len(scene.robots) != 2:
            raise ValueError(f"the scene has {len(scene.robots)} robots; expected a leader and a follower")

    def _prepare(self, worlds: int) -> None:
        super()._prepare(worlds)
        require_beams(self.ranges, _BEAMS)
        self._leaders = self.batch.true_poses[0::2]
        self._free = self.batch.distances[0::2, 0]
        self._routes = np.zeros((worlds, 6, 2))
        self._next = np.zeros(worlds, np.int64)
        self._ticks = np.zeros(worlds, np.int64)
        self._stops = np.zeros(worlds, np.bool_)
        self._worlds = np.arange(worlds)
        self._gaps, self._bearings = np.zeros(worlds), np.zeros(worlds)

    def begin(self, world: int) -> None:
        random = np.random.default_rng(self.seeds[world])
        width, height = self.scenes[world].bounds[2:]
        right, far = width - 1.2, height - 1.2
        route = [(right, 1.2), (right, far), (0.5 * width, far - 0.3), (1.2, far), (1.2, 1.2), (0.5 * width, 1.5)]
        self._routes[world] = np.array(route) + random.uniform(-0.3, 0.3, (6, 2))
        self._stops[world] = random.random() < 0.5
        self._next[world] = self._ticks[world] = 0
        self._look(slice(world, world + 1))

    def command(self, actions: Floats, commands: Floats) -> None:
        commands[1::2] = actions
        away = self._routes[self._worlds, self._next] - self._leaders[:, :2]
        reached = (away * away).sum(axis=1) < _NEAR**2
        if reached.any():
            self._next[:] = (self._next + reached) % 6
            away = self._routes[self._worlds, self._next] - self._leaders[:, :2]
        turn = turned(np.arctan2(away[:, 1], away[:, 0]) - self._leaders[:, 2])
        speed = np.minimum(_LEADER, np.maximum(self._free - 0.15, 0.0)) * np.maximum(np.cos(turn), 0.0)
        commands[0::2, 0] = speed
        commands[0::2, 1] = np.clip(2.0 * turn, -1.0, 1.0)
        commands[0::2][self._stops & (self._ticks % _CYCLE >= _CYCLE - _STOP)] = 0.0
        self._ticks += 1

    def _look(self, worlds: slice) -> None:
        """Finds the leaders from the robots."""
        away = self._leaders[worlds, :2] - self.true_poses[worlds, :2]
        self._gaps[worlds] = np.hypot(away[:, 0], away[:, 1])
        self._bearings[worlds] = turned(np.arctan2(away[:, 1], away[:, 0]) - self.true_poses[worlds, 2])

    def judge(self) -> tuple[Floats, Bools]:
        self._look(slice(None))
        gaps = self._gaps
        rewards = np.maximum(1.0 - np.abs(gaps - SwarmFollowing.GAP) / SwarmFollowing.TOLERANCE, 0.0)
        bad = (self.contacts > 0) | (gaps > SwarmFollowing.LOST)
        rewards[bad] = -SwarmFollowing.COST
        return rewards, bad

    def observe(self, out: NDArray[np.float32]) -> None:
        out[:, 0] = self._gaps
        out[:, 1] = self._bearings
        out[:, 2:4] = self.speeds
        out[:, 4:] = sectors(self.ranges, _SECTORS)
        self.bound(out)


class SwarmFollowing(RobotEnvironment):
    """Follow a leading robot round a hall at a distance of 0.45 m, without touching anything.

    In each episode the leader takes another way round the hall. Half of the leaders stop for 30 of each 100 steps. The
    robot begins behind the leader.

    Observation
        Distance (m) and bearing from straight ahead (rad) of the leader, as a radio beacon on it tells, without
        errors; linear speed (m/s), angular speed (rad/s), and the nearest range in each of 36 sectors of 10 degrees
        (m, 10 without a return), counter-clockwise from behind.
    Action
        Linear speed, 0 to 0.3 m/s, and angular speed, -2 to 2 rad/s.
    Reward
        ``1 - |d - 0.45| / 0.3`` for each step, and 0 farther off, where d is the true distance between the centres of
        the robots (m). A contact, or a distance of more than 2 m, costs 10 and ends the episode.

    Parameters
    ----------
    render_mode : {None, "svg"}
        With ``svg``, `render` returns a picture as text.
    noise : float
        Errors of drives and sensors as a multiple of those of the real robot.
    period : float, optional
        Duration of a step, otherwise 0.1 (s).
    """

    TASK = _SwarmTask
    GAP = 0.45
    """Distance to keep from the leader (m)."""
    TOLERANCE = 0.3
    """Error of the distance at which no reward is left (m)."""
    LOST = 2.0
    """Distance from which the leader is lost (m)."""
    COST = 10.0
    """Cost of a contact and of losing the leader."""

    def baseline(self) -> BehaviourPolicy:
        """The library's follower, which finds the leader with the lidar."""
        return BehaviourPolicy(self, Follower(self.GAP, 0.3, _RADIUS, _RADIUS))
