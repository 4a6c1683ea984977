"""Environments for Gymnasium: wall following and goal reaching with a simulated robot.

Importing this module registers ``roverlab/WallFollowing-v0`` and ``roverlab/GoalReaching-v0``. Observations, actions
and rewards are in metres, seconds and radians. Each environment has a `baseline`, the library's own behaviour, and
`score` measures any policy.
"""

from importlib.util import find_spec as _find_spec

if _find_spec("gymnasium") is None:
    raise ModuleNotFoundError("roverlab.envs needs gymnasium; expected: pip install roverlab[envs]")

import gymnasium as _gymnasium

from ._score import score
from .goal_reaching import GoalReaching
from .wall_following import WallFollowing

__all__ = ["GoalReaching", "WallFollowing", "score"]


def _register() -> None:
    for name, environment, steps in (
        ("roverlab/WallFollowing-v0", WallFollowing, 1200),
        ("roverlab/GoalReaching-v0", GoalReaching, 3000),
    ):
        if name not in _gymnasium.registry:
            entry = f"{environment.__module__}:{environment.__name__}"
            _gymnasium.register(name, entry_point=entry, max_episode_steps=steps)


_register()
