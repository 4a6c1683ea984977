"""Measuring policies."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from ._base import Action, Observation

Policy = Callable[[Observation], Action]


def score(
    environment: gymnasium.Env[Observation, Action],
    seeds: Iterable[int],
    policy: Policy | None = None,
) -> NDArray[np.float64]:
    """Sum of the rewards of one episode for each seed.

    Parameters
    ----------
    environment : gymnasium.Env
        One of this module's environments, as `gymnasium.make` returns it.
    seeds : iterable of int
        Seeds of the episodes.
    policy : callable, optional
        Function from observation to action; otherwise the environment's `baseline`, begun anew in each episode.

    Returns
    -------
    ndarray of float64, shape (seeds,)
        The sums.
    """
    return np.array([_episode(environment, seed, policy) for seed in seeds], dtype=np.float64)


def _episode(environment: gymnasium.Env[Observation, Action], seed: int, policy: Policy | None) -> float:
    observation, _ = environment.reset(seed=seed)
    inner: Any = environment.unwrapped
    decide: Policy = inner.baseline() if policy is None else policy
    total, over = 0.0, False
    while not over:
        observation, reward, terminated, truncated, _ = environment.step(decide(observation))
        total, over = total + float(reward), terminated or truncated
    return total
