"""Trains a wall follower by CMA-ES in at most a minute, and scores it in 100 rooms that it has not seen.

The policy is one layer on the distances, near and far, and the speeds. The library's PID controller is beside it.
"""

import sys
import time

import gymnasium
import numpy as np
from numpy.typing import NDArray

from roverlab import envs
from roverlab.evolve import CmaEs

CROWD, ROOMS, STEPS, GENES = 16, 8, 500, 16
Floats = NDArray[np.float64]


def policy(weights: Floats, seen: NDArray[np.float32]) -> NDArray[np.float32]:
    """Actions of shape (..., 2) for weights of shape (..., GENES) and observations of shape (..., 5)."""
    near, far = np.minimum(seen[..., :3], 0.4) / 0.1 - 2.0, np.minimum(seen[..., :2], 1.0) / 0.25 - 2.0
    inputs = np.concatenate([near, far, seen[..., 3:] / [0.3, 2.0], np.ones_like(seen[..., :1])], axis=-1)
    out = np.tanh(np.einsum("...oi,...i->...o", weights.reshape(*weights.shape[:-1], 2, 8), inputs))
    return np.stack([0.15 + 0.07 * out[..., 0], 2.0 * out[..., 1]], axis=-1).astype(np.float32)


def main(limit: float) -> None:
    start = time.perf_counter()
    search = CmaEs(np.zeros(GENES), 0.4, CROWD, seed=1)
    worlds = envs.RobotVectorEnvironment(envs.WallFollowing, CROWD * ROOMS, threads=2, max_episode_steps=STEPS)

    def fitness(genomes: Floats) -> Floats:
        # All individuals in the same rooms, which differ from generation to generation.
        seeds = [1_000_000 + 1000 * len(search.history) + room for room in range(ROOMS)]
        seen, _ = worlds.reset(seed=seeds * len(genomes))
        weights, score = np.repeat(genomes, ROOMS, axis=0), np.zeros(len(genomes) * ROOMS)
        alive = np.ones(len(score), np.bool_)
        for _ in range(STEPS):
            seen, rewards, over, _, _ = worlds.step(policy(weights, seen))
            score += np.where(alive, rewards, 0.0) - 3.0 * (alive & over)
            alive &= ~over
        return np.asarray(score.reshape(len(genomes), ROOMS).mean(axis=1))

    while time.perf_counter() - start < limit:
        search.step(fitness)
    print(f"{len(search.history)} generations in {time.perf_counter() - start:.0f} s")
    env, rooms = gymnasium.make("roverlab/WallFollowing-v0"), range(100 if limit > 10.0 else 3)
    for name, chosen in (("trained", lambda seen: policy(search.mean, seen)), ("PID", None)):
        scores = envs.score(env, rooms, chosen)
        print(f"{name}: mean score {scores.mean():.2f}, {(scores > 0.0).sum()} of {len(scores)} rooms without contact")


if __name__ == "__main__":
    # The tests of the package stay short.
    main(1.0 if len(sys.argv) > 1 else 58.0)
