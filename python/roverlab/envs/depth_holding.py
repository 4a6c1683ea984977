"""Holding a depth under water."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..drive import Dive
from ..sim import RobotSpec, Scene
from ._base import BehaviourPolicy, RobotEnvironment
from ._task import Bools, Floats, Task, turned

_DEPTHS = (0.4, 1.1)
"""Depths between which one is drawn (m)."""
_SENSOR = 0.26
"""Height of the depth sensor above the craft's origin (m)."""
_CRAFT = RobotSpec("Mako")


class _DepthTask(Task):
    LOW = (-5.0, -np.pi, -np.pi, -np.pi, -5.0, -5.0, -5.0)
    HIGH = (5.0, np.pi, np.pi, np.pi, 5.0, 5.0, 5.0)
    SLOWEST = (-1.0, -1.0, -1.0, -1.0)
    FASTEST = (1.0, 1.0, 1.0, 1.0)
    SPACE = True
    THRUSTERS = True

    def draw(self, seed: int) -> Scene:
        return Scene.pool(seed)

    def place(self, scene: Scene) -> None:
        if scene.water_level is None:
            raise ValueError("the scene has no water; expected some, as `Scene.pool` has")
        if not scene.robots:
            scene.add_robot(_CRAFT)

    def _prepare(self, worlds: int) -> None:
        super()._prepare(worlds)
        self._levels, self.depths, self.headings = np.zeros(worlds), np.zeros(worlds), np.zeros(worlds)

    def begin(self, world: int) -> None:
        self._levels[world] = self.scenes[world].water_level
        self.depths[world] = np.random.default_rng(self.seeds[world]).uniform(*_DEPTHS)
        self.headings[world] = self.true_poses[world, 2]

    def judge(self) -> tuple[Floats, Bools]:
        depths = self._levels - self.space[:, 7] - _SENSOR
        off = np.abs(depths - self.depths) / DepthHolding.TOLERANCE
        aside = np.abs(turned(self.true_poses[:, 2] - self.headings)) / DepthHolding.TURNED
        rewards = np.maximum(1.0 - off, 0.0) * np.maximum(1.0 - aside, 0.0)
        touched = self.contacts > 0
        rewards[touched] = -DepthHolding.COST
        return rewards, touched

    def observe(self, out: NDArray[np.float32]) -> None:
        space = self.space
        out[:, 0] = space[:, 6] - self.depths
        out[:, 1:3] = space[:, :2]
        out[:, 3] = turned(space[:, 2] - self.headings)
        out[:, 4:] = space[:, 3:6]
        self.bound(out)


class DepthHolding(RobotEnvironment):
    """Dive to a depth with an underwater craft, and hold that and the heading.

    Each episode has another pool and another depth between 0.4 and 1.1 m. The Mako floats at first, far from the sides;
    it has two thrusters along its hull and two upright ones.

    Observation
        Depth by the pressure sensor less the wanted one (m), roll and pitch (rad), turn from the wanted heading (rad),
        and turn rates about the axes ahead, to the left and upwards (rad/s), by the inertial unit.
    Action
        Command of each of the four thrusters as a fraction of its full speed, -1 to 1.
    Reward
        For each step ``(1 - |d| / 0.1) (1 - |a| / 0.5)``, where d is the true error of the depth (m) and a that of the
        heading (rad), and 0 if either is farther off. A contact costs 10 and ends the episode.

    Parameters
    ----------
    render_mode : {None, "svg"}
        With ``svg``, `render` returns a picture as text.
    noise : float
        Errors of drives and sensors as a multiple of those of the real robot.
    period : float, optional
        Duration of a step, otherwise 0.1 (s).
    """

    TASK = _DepthTask
    TOLERANCE = 0.1
    """Error of the depth at which no reward is left (m)."""
    TURNED = 0.5
    """Error of the heading at which no reward is left (rad)."""
    COST = 10.0
    """Cost of a contact."""

    def baseline(self) -> BehaviourPolicy:
        """The library's dive, which goes by a model of the craft."""
        assert isinstance(self.task, _DepthTask)
        return BehaviourPolicy(self, Dive(_CRAFT, self.task.depths[0], self.task.headings[0]))
