"""Racing on a track of cones."""

from __future__ import annotations

import math

from ..drive import Racer
from ..sim import Scene
from ._base import BehaviourPolicy, RobotEnvironment
from ._track import TrackTask, driven


class _RaceTask(TrackTask):
    CAR = "RaceCar"
    AHEAD = (3.0, 6.0, 10.0, 15.0, 22.0, 30.0)
    SLOWEST = (0.0, -0.4)
    FASTEST = (20.0, 0.4)
    LOW = (-30.0, -10.0, -10.0, -math.pi, *[-50.0] * (2 * len(AHEAD)))
    HIGH = (30.0, 10.0, 10.0, math.pi, *[50.0] * (2 * len(AHEAD)))

    def draw(self, seed: int) -> Scene:
        return Scene.track(seed)


class ConeRacing(RobotEnvironment):
    """Race on a track of cones for 60 s, as far as possible, without touching one.

    Each episode has another closed track of 200 to 500 m, 3 to 5 m wide. The racing car of 1.55 m between the axles
    begins before the start line; it slips if it is too fast for a bend.

    Observation
        Linear (m/s) and angular speed (rad/s) by the wheels; distance to the left of the centre line (m), turn from
        its direction (rad), and the points of the centre line 3, 6, 10, 15, 22 and 30 m ahead, each by its distance
        ahead of and to the left of the rear axle (m). Except for the speeds these are true values, as a map tells.
    Action
        Speed, 0 to 20 m/s, and curvature of the way, -0.4 to 0.4 1/m, positive to the left.
    Reward
        Way along the centre line (m). A contact, or the car's middle off the track, costs 10 and ends the episode.

    Parameters
    ----------
    render_mode : {None, "svg"}
        With ``svg``, `render` returns a picture as text.
    noise : float
        Errors of drives and sensors as a multiple of those of the real robot.
    period : float, optional
        Duration of a step, otherwise 0.05 (s).
    """

    TASK = _RaceTask
    PERIOD = 0.05

    def baseline(self) -> BehaviourPolicy:
        """The library's racer, which maps the track with the lidar in the first lap and then takes a racing line."""
        return BehaviourPolicy(self, Racer(1000), driven)
