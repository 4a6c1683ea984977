"""Many episodes at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from ..sim import Batch, Simulation
from ._base import RobotEnvironment, batch_options, begun, checked, next_scene, picture, speeds

Observations = NDArray[np.float32]
Actions = NDArray[np.float32]


class RobotVectorEnvironment(gymnasium.vector.VectorEnv[Observations, Actions, NDArray[Any]]):
    """Episodes of an environment side by side, in the worlds of one `roverlab.sim.Batch`.

    `gymnasium.make_vec` returns it for the ids of this package. World ``i`` of ``reset(seed=s)`` runs as an
    environment of its own with the seed ``s + i`` does, to the bit.

    An episode that is over begins again in the next step (`AutoresetMode.NEXT_STEP`): that step ignores the world's
    action, its observation is the first of the new episode, and its reward is 0.

    Parameters
    ----------
    environment : type
        Class of the environment.
    num_envs : int
        Number of worlds.
    render_mode : {None, "svg"}
        With ``svg``, `render` returns a picture of each world as text.
    noise : float
        Errors of drives and sensors as a multiple of those of the real robot.
    period : float, optional
        Duration of a step (s); otherwise the environment's own.
    max_episode_steps : int, optional
        Steps after which an episode is truncated.
    threads : int
        Number of threads among which the worlds are divided; results do not depend on it.
    copy : bool
        Whether observations are new arrays; otherwise each step writes into the same one.
    """

    def __init__(
        self,
        environment: type[RobotEnvironment],
        num_envs: int = 1,
        render_mode: str | None = None,
        noise: float = 1.0,
        period: float | None = None,
        max_episode_steps: int | None = None,
        threads: int = 1,
        copy: bool = True,
    ) -> None:
        if num_envs < 1:
            raise ValueError(f"num_envs is {num_envs}; expected at least 1")
        if max_episode_steps is not None and max_episode_steps < 1:
            raise ValueError(f"max_episode_steps is {max_episode_steps}; expected at least 1")
        self.metadata = {**environment.metadata, "autoreset_mode": AutoresetMode.NEXT_STEP}
        self.task = environment.TASK()
        self.num_envs, self.render_mode = num_envs, render_mode
        self.period = checked(render_mode, environment.PERIOD if period is None else period)
        self.single_observation_space = gymnasium.spaces.Box(self.task.low, self.task.high)
        self.single_action_space = gymnasium.spaces.Box(*speeds(self.task))
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._options = batch_options(self.task, render_mode, noise) | {"threads": threads}
        self._most = max_episode_steps
        self._copy = copy
        self._randoms: list[Any] = [None] * num_envs
        self._steps = np.zeros(num_envs, np.int64)
        self._over = np.zeros(num_envs, np.bool_)
        self._actions = np.zeros((num_envs, len(self.task.slowest)))
        # A bound for each value: numpy repeats short rows slowly.
        self._slowest, self._fastest = (np.tile(row, (num_envs, 1)) for row in (self.task.slowest, self.task.fastest))
        self._seen = np.zeros((num_envs, len(self.task.low)), np.float32)
        self._everywhere = np.ones(num_envs, np.bool_)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begins an episode in each world.

        Parameters
        ----------
        seed : int or sequence of int, optional
            Seed of the first world, whose number is counted up for the next ones, or a seed for each. Without it, the
            worlds go on with their sequences of episodes.
        options : dict, optional
            ``scene``: a `Scene` to take in all worlds instead of random ones.
        """
        count = self.num_envs
        if seed is None or isinstance(seed, (int, np.integer)):
            seeds: list[int | None] = [None if seed is None else int(seed) + world for world in range(count)]
        else:
            seeds = [None if own is None else int(own) for own in seed]
        if len(seeds) != count:
            raise ValueError(f"seed has {len(seeds)} numbers; expected {count}, one for each environment")
        for world, own in enumerate(seeds):
            if own is not None or self._randoms[world] is None:
                self._randoms[world] = seeding.np_random(own)[0]
        starts = [next_scene(self.task, random, options) for random in self._randoms]
        scenes, drawn = [scene for scene, _ in starts], [own for _, own in starts]
        self.batch = Batch(scenes, **self._options)
        for world, own in enumerate(drawn):
            self.batch.reset(world, own)
        self._commands = np.zeros((len(self.batch), self._actions.shape[1]))
        self.task.attach(scenes, drawn, self.batch)
        self._steps[:] = 0
        self._over[:] = False
        return self._observe(), self._facts()

    def step(
        self, actions: Actions
    ) -> tuple[Observations, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Drives all robots for one period.

        Parameters
        ----------
        actions : ndarray, shape (num_envs, numbers of an action)
            The action of each robot.
        """
        task, steps = self.task, self._steps
        begun(self.task)
        given = np.asarray(actions)
        if given.shape != self._actions.shape:
            raise ValueError(f"actions is an array of shape {given.shape}; expected shape {self._actions.shape}")
        np.maximum(given, self._slowest, out=self._actions)
        np.minimum(self._actions, self._fastest, out=self._actions)
        task.command(self._actions, self._commands)
        self.batch.step(self._commands, self.period)
        rewards, terminated = task.judge()
        steps += 1
        truncated = np.zeros(self.num_envs, np.bool_) if self._most is None else steps >= self._most
        if self._over.any():
            for world in np.flatnonzero(self._over).tolist():
                self._begin(world)
            rewards[self._over] = 0.0
            terminated &= ~self._over
            truncated &= ~self._over
        self._over = terminated | truncated
        return self._observe(), rewards, terminated, truncated, self._facts()

    def render(self) -> tuple[str, ...] | None:
        """Pictures of the worlds, as the texts of SVG files."""
        begun(self.task)
        if self.render_mode is None:
            return None
        return tuple(picture(self.simulation(world), scene) for world, scene in enumerate(self.task.scenes))

    def simulation(self, world: int) -> Simulation:
        """A world until its next episode, with its robots and their truth."""
        return self.batch.simulation(world)

    def _begin(self, world: int) -> None:
        """Begins the next episode of a world."""
        scene, drawn = next_scene(self.task, self._randoms[world], None)
        self.batch.reset(world, drawn, scene)
        self.task.scenes[world], self.task.seeds[world] = scene, drawn
        self.task.begin(world)
        self._steps[world] = 0

    def _observe(self) -> Observations:
        self.task.observe(self._seen)
        return self._seen.copy() if self._copy else self._seen

    def _facts(self) -> dict[str, Any]:
        task, all_of_them = self.task, self._everywhere
        return {
            "pose": task.true_poses.copy(),
            "_pose": all_of_them,
            "contacts": task.contacts.copy(),
            "_contacts": all_of_them,
            "time": self._steps * self.period,
            "_time": all_of_them,
        }
