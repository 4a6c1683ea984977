"""Trains a wall follower by a policy gradient, and scores it in 100 rooms that it has not seen.

The method is PPO of Stable-Baselines3, which needs `pip install 'roverlab[train]'`.
"""

import sys
import time

import gymnasium
import numpy as np
from numpy.typing import NDArray
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import DummyVecEnv

from roverlab import envs

WORLDS = 8


def environment() -> gymnasium.Env[NDArray[np.float32], NDArray[np.float32]]:
    """Actions and observations of the size that a network likes: distances up to 1 m, and all of about one."""
    env = gymnasium.make("roverlab/WallFollowing-v0", max_episode_steps=500)
    env = gymnasium.wrappers.RescaleAction(env, np.float32(-1.0), np.float32(1.0))
    return gymnasium.wrappers.TransformObservation(env, inputs, gymnasium.spaces.Box(-10.0, 10.0, (5,)))


def inputs(seen: NDArray[np.float32]) -> NDArray[np.float32]:
    distances = np.minimum(seen[:3], 1.0) / 0.25 - 2.0
    return np.concatenate([distances, seen[3:] / [0.3, 2.0]]).astype(np.float32)


def main(steps: int) -> None:
    start = time.perf_counter()
    worlds = DummyVecEnv([environment] * WORLDS)
    policy = {"log_std_init": -1.0, "net_arch": [32, 32]}
    # Metres along the wall in a step are few, so the value of what is far away counts little.
    sizes = {"n_steps": 512, "batch_size": 256, "gamma": 0.98}
    model = PPO("MlpPolicy", worlds, seed=1, policy_kwargs=policy, device="cpu", **sizes)
    model.learn(steps)
    print(f"{model.num_timesteps} steps in {time.perf_counter() - start:.0f} s")
    scaled = environment()
    low, high = scaled.unwrapped.action_space.low, scaled.unwrapped.action_space.high  # type: ignore[attr-defined]

    def trained(seen: NDArray[np.float32]) -> NDArray[np.float32]:
        action, _ = model.predict(inputs(seen), deterministic=True)
        return np.asarray(low + 0.5 * (np.clip(action, -1.0, 1.0) + 1.0) * (high - low), np.float32)

    env = gymnasium.make("roverlab/WallFollowing-v0")
    for name, chosen in (("trained", trained), ("PID", None)):
        scores = envs.score(env, range(100 if steps > 10_000 else 3), chosen)
        print(f"{name}: mean score {scores.mean():.2f}, {(scores > 0.0).sum()} of {len(scores)} rooms without contact")


if __name__ == "__main__":
    # The tests of the package stay short.
    main(4096 if len(sys.argv) > 1 else 300_000)
