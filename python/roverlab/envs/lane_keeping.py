"""Keeping a lane."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..drive import LaneKeeper
from ..sim import Scene
from ._base import BehaviourPolicy, RobotEnvironment
from ._track import TrackTask, driven


class _LaneTask(TrackTask):
    CAR = "RoadCar"
    AHEAD = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0)
    SLOWEST = (0.0, -2.0)
    FASTEST = (3.0, 2.0)
    LOW = (-5.0, -20.0, -1.0, -math.pi, *[-5.0] * (2 * len(AHEAD)))
    HIGH = (5.0, 20.0, 1.0, math.pi, *[5.0] * (2 * len(AHEAD)))

    def draw(self, seed: int) -> Scene:
        # The picture of a floor takes megabytes, and only a camera sees it.
        return Scene.road(seed, None)


class _SeenLaneTask(_LaneTask):
    def draw(self, seed: int) -> Scene:
        return Scene.road(seed)


class LaneKeeping(RobotEnvironment):
    """Drive a model car in the right lane of a closed road for 60 s, as far as possible.

    Each episode has another road of two lanes, of 0.35 to 0.45 m each, with straights and bends. The car of 0.26 m
    between the axles begins in its lane; it slips if it is too fast for a bend.

    Observation
        Linear (m/s) and angular speed (rad/s) by the wheels; distance to the left of the middle of the lane (m), turn
        from its direction (rad), and the points of the middle 0.25, 0.5, 0.75, 1, 1.5 and 2 m ahead, each by its
        distance ahead of and to the left of the rear axle (m). Except for the speeds these are true values.
    Action
        Speed, 0 to 3 m/s, and curvature of the way, -2 to 2 1/m, positive to the left.
    Reward
        Way along the lane (m). If the car's middle leaves the lane, that costs 10 and ends the episode.

    Parameters
    ----------
    render_mode : {None, "svg"}
        With ``svg``, `render` returns a picture as text.
    noise : float
        Errors of drives and sensors as a multiple of those of the real robot.
    period : float, optional
        Duration of a step, otherwise 0.03 (s).
    camera : bool
        Whether the markings are on the floor, for the car's camera and pictures. Worlds of a vector have none.
    """

    TASK = _LaneTask
    PERIOD = 0.03

    def __init__(
        self,
        render_mode: str | None = None,
        noise: float = 1.0,
        period: float | None = None,
        camera: bool = True,
    ) -> None:
        super().__init__(render_mode, noise, period)
        if camera:
            self.task = _SeenLaneTask()

    def image(self) -> NDArray[np.uint8]:
        """What the car's camera sees now, of shape (240, 320, 3)."""
        return self.robot.image()

    def baseline(self) -> BehaviourPolicy:
        """The library's lane keeper, which sees the lane with the camera."""
        return BehaviourPolicy(self, LaneKeeper(), driven)
