"""Cars on closed tracks and lanes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..sim import Scene
from ._task import Bools, Floats, Task


class TrackTask(Task):
    """A car that should drive along the centre line of its scene. Actions are speed (m/s) and curvature (1/m)."""

    CAR: ClassVar[str]
    """Name of the car."""
    COST: ClassVar[float] = 10.0
    """Cost of leaving the track, and of a contact."""

    def place(self, scene: Scene) -> None:
        if not scene.robots:
            scene.add_robot(self.CAR)

    def _prepare(self, worlds: int) -> None:
        super()._prepare(worlds)
        self._along = np.zeros(worlds)

    def begin(self, world: int) -> None:
        self._along[world] = self.lanes[world, 0]

    def command(self, actions: Floats, commands: Floats) -> None:
        commands[:, 0] = actions[:, 0]
        np.multiply(actions[:, 0], actions[:, 1], out=commands[:, 1])

    def judge(self) -> tuple[Floats, Bools]:
        rewards = self.lanes[:, 0] - self._along
        length = self.lanes[:, 1]
        # The shorter way round.
        rewards -= length * np.rint(rewards / length)
        self._along[:] = self.lanes[:, 0]
        over: Bools = (self.lanes[:, 4] < 0.0) | (self.contacts > 0)
        rewards[over] = -self.COST
        return rewards, over

    def observe(self, out: NDArray[np.float32]) -> None:
        out[:, :2] = self.speeds
        out[:, 2:4] = self.lanes[:, 2:4]
        out[:, 4:] = self.lanes[:, 5:]
        self.bound(out)


def driven(speeds: Sequence[float]) -> tuple[float, float]:
    """The action of a linear (m/s) and an angular speed (rad/s)."""
    linear, angular = speeds
    return linear, angular / linear if linear > 1e-6 else 0.0
