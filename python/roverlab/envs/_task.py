"""Observations and rewards of an environment, for the rows of a batch of worlds."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..sim import Batch, Scene

FARTHEST = 10.0
"""Distance that stands for a range without a return (m)."""

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


class Task(ABC):
    """What is observed and rewarded in many worlds at once. Each row of its arrays is a world."""

    LOW: ClassVar[Sequence[float]]
    """Smallest values of an observation."""
    HIGH: ClassVar[Sequence[float]]
    """Largest values of an observation."""
    SLOWEST: ClassVar[Sequence[float]] = (0.0, -2.0)
    """Lowest linear (m/s) and angular speed (rad/s), or thrusts, of an action."""
    FASTEST: ClassVar[Sequence[float]] = (0.3, 2.0)
    """Highest linear (m/s) and angular speed (rad/s), or thrusts, of an action."""
    ROBOT: ClassVar[int] = 0
    """Index of the robot in its scene."""
    SCAN: ClassVar[bool] = False
    """Whether each step takes scans."""
    WALLS: ClassVar[bool] = False
    """Whether each step finds the nearest walls."""
    SPACE: ClassVar[bool] = False
    """Whether each step reads the robot's attitude and depth."""
    THRUSTERS: ClassVar[bool] = False
    """Whether actions are commands of thrusters instead of speeds."""
    AHEAD: ClassVar[Sequence[float] | None] = None
    """Distances along the centre line of the points that each step finds (m)."""

    batch: Batch
    scenes: list[Scene]
    seeds: list[int]

    def __init__(self) -> None:
        self.low = np.array(self.LOW, np.float32)
        self.high = np.array(self.HIGH, np.float32)
        self.slowest, self.fastest = np.array(self.SLOWEST), np.array(self.FASTEST)

    @abstractmethod
    def draw(self, seed: int) -> Scene:
        """A random world with a start."""

    def place(self, scene: Scene) -> None:
        """Adds the robots that a scene lacks."""
        if not scene.robots:
            scene.add_robot("S4")

    def attach(self, scenes: list[Scene], seeds: list[int], batch: Batch) -> None:
        """Takes a batch that begins with these scenes."""
        self.scenes, self.seeds, self.batch = scenes, seeds, batch
        self._prepare(len(scenes))
        for world in range(len(scenes)):
            self.begin(world)

    def _own(self, rows: NDArray[np.generic]) -> NDArray[np.generic]:
        """Of rows for all robots, those of the robot that is judged."""
        return rows[self.ROBOT :: len(self.batch) // len(self.scenes)]

    def _prepare(self, worlds: int) -> None:
        """Allocates what is remembered of each world, and takes views of the batch's arrays."""
        batch = self.batch
        # A bound for each value: numpy repeats short rows slowly.
        self._lows, self._highs = (np.tile(row, (worlds, 1)) for row in (self.low, self.high))
        self.distances: Floats = self._own(batch.distances)  # type: ignore[assignment]
        self.ranges: Floats = self._own(batch.ranges)  # type: ignore[assignment]
        self.poses: Floats = self._own(batch.poses)  # type: ignore[assignment]
        self.speeds: Floats = self._own(batch.speeds)  # type: ignore[assignment]
        self.true_poses: Floats = self._own(batch.true_poses)  # type: ignore[assignment]
        self.walls: Floats = self._own(batch.walls)  # type: ignore[assignment]
        self.lanes: Floats = self._own(batch.lanes)  # type: ignore[assignment]
        self.space: Floats = self._own(batch.space)  # type: ignore[assignment]
        self.contacts: NDArray[np.uint32] = self._own(batch.contacts)  # type: ignore[assignment]

    def bound(self, out: NDArray[np.float32]) -> None:
        """Brings observations between the smallest and the largest values."""
        np.maximum(out, self._lows, out=out)
        np.minimum(out, self._highs, out=out)

    @abstractmethod
    def begin(self, world: int) -> None:
        """Sets what the reward of a world's first step is relative to."""

    def command(self, actions: Floats, commands: Floats) -> None:
        """Writes what all robots are told."""
        commands[:] = actions

    @abstractmethod
    def judge(self) -> tuple[Floats, Bools]:
        """Rewards of the last step, and which episodes are over."""

    @abstractmethod
    def observe(self, out: NDArray[np.float32]) -> None:
        """Writes what the robots sense now."""


def require_beams(ranges: Floats, beams: int) -> None:
    """Checks a scene's lidar."""
    if ranges.shape[1] != beams:
        raise ValueError(f"the robot's lidar has {ranges.shape[1]} beams; expected {beams}")


def require_sensors(distances: Floats, sensors: int) -> None:
    """Checks a scene's distance sensors."""
    if distances.shape[1] < sensors:
        raise ValueError(f"the robot has {distances.shape[1]} distance sensors; expected at least {sensors}")


def sectors(ranges: Floats, count: int) -> Floats:
    """The nearest range in each of some sectors of a scan, counter-clockwise from behind (m)."""
    parts = ranges.reshape(len(ranges), count, -1)
    nearest = parts[:, :, 0].copy()
    # Beam by beam: numpy's own minimum over a short last axis takes longer.
    for beam in range(1, parts.shape[2]):
        np.minimum(nearest, parts[:, :, beam], out=nearest)
    return nearest


def turned(angles: Floats) -> Floats:
    """Angles between -pi and pi (rad)."""
    return (angles + np.pi) % (2.0 * np.pi) - np.pi
