"""Environments for Gymnasium: tasks of a simulated robot.

Importing this module registers the ids of `ENVIRONMENTS`: ``gymnasium.make`` returns one environment, and
``gymnasium.make_vec`` many in one `roverlab.sim.Batch`. Observations, actions and rewards are in metres, seconds and
radians. Each environment has a `baseline`, the library's own behaviour, and `score` measures any policy.
"""

from functools import partial as _partial
from importlib.util import find_spec as _find_spec

if _find_spec("gymnasium") is None:
    raise ModuleNotFoundError("roverlab.envs needs gymnasium; expected: pip install roverlab[envs]")

import gymnasium as _gymnasium

from ._base import RobotEnvironment
from ._score import score
from ._vector import RobotVectorEnvironment
from .cone_racing import ConeRacing
from .depth_holding import DepthHolding
from .goal_reaching import GoalReaching
from .hill_climbing import HillClimbing
from .lane_keeping import LaneKeeping
from .maze_exploration import MazeExploration
from .swarm_following import SwarmFollowing
from .wall_following import WallFollowing

__all__ = [
    "ENVIRONMENTS",
    "ConeRacing",
    "DepthHolding",
    "GoalReaching",
    "HillClimbing",
    "LaneKeeping",
    "MazeExploration",
    "RobotEnvironment",
    "RobotVectorEnvironment",
    "SwarmFollowing",
    "WallFollowing",
    "score",
]

ENVIRONMENTS: dict[str, tuple[type[RobotEnvironment], int]] = {
    "roverlab/WallFollowing-v0": (WallFollowing, 1200),
    "roverlab/GoalReaching-v0": (GoalReaching, 3000),
    "roverlab/MazeExploration-v0": (MazeExploration, 2400),
    "roverlab/SwarmFollowing-v0": (SwarmFollowing, 600),
    "roverlab/ConeRacing-v0": (ConeRacing, 1200),
    "roverlab/LaneKeeping-v0": (LaneKeeping, 2000),
    "roverlab/HillClimbing-v0": (HillClimbing, 900),
    "roverlab/DepthHolding-v0": (DepthHolding, 600),
}
"""Ids, with the class of the environment and the number of steps after which an episode is truncated."""


def _register() -> None:
    for name, (environment, steps) in ENVIRONMENTS.items():
        if name not in _gymnasium.registry:
            entry = f"{environment.__module__}:{environment.__name__}"
            vector = _partial(RobotVectorEnvironment, environment)
            _gymnasium.register(name, entry_point=entry, vector_entry_point=vector, max_episode_steps=steps)


_register()
