"""What the environments have in common."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, ClassVar, Protocol

import gymnasium
import numpy as np
from numpy.typing import NDArray

from ..sim import Batch, Robot, Scene, Simulation
from ._task import Task

Observation = NDArray[np.float32]
Action = NDArray[np.float32]


class Behaviour(Protocol):
    """A behaviour of the library."""

    def decide(self, robot: Robot) -> Sequence[float]:
        """Reads the robot's sensors and decides."""


class BehaviourPolicy:
    """A policy that is a behaviour of the library on the robot of an environment.

    Parameters
    ----------
    environment : RobotEnvironment
        The environment.
    behaviour : Behaviour
        The behaviour.
    action : callable, optional
        Function from the behaviour's decision to an action.
    """

    def __init__(
        self,
        environment: RobotEnvironment,
        behaviour: Behaviour,
        action: Callable[[Sequence[float]], Sequence[float]] | None = None,
    ) -> None:
        self._environment, self._behaviour, self._action = environment, behaviour, action

    def __call__(self, observation: Observation) -> Action:
        """The action for now; the robot's own sensors are read, not the observation."""
        decision = self._behaviour.decide(self._environment.robot)
        return np.array(decision if self._action is None else self._action(decision), np.float32)


class RobotEnvironment(gymnasium.Env[Observation, Action]):
    """A robot in a random world."""

    metadata = {"render_modes": ["svg"], "render_fps": 10}

    TASK: ClassVar[type[Task]]
    """What is observed and rewarded."""
    PERIOD: ClassVar[float] = 0.1
    """Usual duration of a step (s)."""

    scene: Scene
    simulation: Simulation
    robot: Robot

    def __init__(self, render_mode: str | None = None, noise: float = 1.0, period: float | None = None) -> None:
        self.task = self.TASK()
        self.render_mode = render_mode
        self.noise = noise
        self.period = checked(render_mode, self.PERIOD if period is None else period)
        self.observation_space = gymnasium.spaces.Box(self.task.low, self.task.high)
        self.action_space = gymnasium.spaces.Box(*speeds(self.task))
        self._seen = np.zeros((1, len(self.task.low)), np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begins an episode in a world that the seed determines.

        Parameters
        ----------
        seed : int, optional
            Seed of this episode and those that follow; without it, the next one of the sequence.
        options : dict, optional
            ``scene``: a `Scene` to take instead of a random world. Its `start` is the robot's.
        """
        super().reset(seed=seed)
        self.scene, drawn = next_scene(self.task, self.np_random, options)
        batch = Batch(self.scene, seed=drawn, **batch_options(self.task, self.render_mode, self.noise))
        self._commands = np.zeros((len(batch), len(self.task.slowest)))
        self.task.attach([self.scene], [drawn], batch)
        self.simulation = batch.simulation()
        self.robot = self.simulation.robot(self.task.ROBOT)
        return self._observe(), self._facts()

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Drives as the action says for one period."""
        task = self.task
        begun(task)
        wanted = np.asarray(action, np.float64)[None]
        task.command(np.clip(wanted, task.slowest, task.fastest), self._commands)
        task.batch.step(self._commands, self.period)
        rewards, over = task.judge()
        return self._observe(), float(rewards[0]), bool(over[0]), False, self._facts()

    def render(self) -> str | None:
        """Picture of the world and the way so far, as the text of an SVG file."""
        begun(self.task)
        return picture(self.simulation, self.scene) if self.render_mode == "svg" else None

    def _observe(self) -> Observation:
        self.task.observe(self._seen)
        seen: Observation = self._seen[0].copy()
        return seen

    def _facts(self) -> dict[str, Any]:
        truth = self.simulation.truth
        robot = self.task.ROBOT
        return {"pose": truth.pose(robot), "contacts": truth.contacts(robot), "time": self.simulation.time}


def begun(task: Task) -> None:
    """Fails before the first episode."""
    if not hasattr(task, "batch"):
        raise gymnasium.error.ResetNeeded("no episode has begun; expected reset() first")


def checked(render_mode: str | None, period: float) -> float:
    """The period; fails if it or the mode of pictures is not one that there is."""
    if render_mode not in (None, "svg"):
        raise ValueError(f"render_mode is {render_mode!r}; expected None or 'svg'")
    if not 0.01 <= period <= 1.0:
        raise ValueError(f"period is {period}; expected 0.01 to 1 s")
    return period


def picture(simulation: Simulation, scene: Scene) -> str:
    """A world with its robots, and the middle of its track."""
    line = scene.centre_line
    return simulation.to_svg(path=None if line is None else line[:, :2])


def speeds(task: Task) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Lowest and highest speeds or thrusts of an action."""
    return task.slowest.astype(np.float32), task.fastest.astype(np.float32)


def batch_options(task: Task, render_mode: str | None, noise: float) -> dict[str, Any]:
    """Options of the batch of a task."""
    trail = 0.1 if render_mode else None
    found = {"scan": task.SCAN, "walls": task.WALLS, "ahead": task.AHEAD, "space": task.SPACE}
    return {"noise": noise, "trail_interval": trail, "thrusters": task.THRUSTERS, **found}


def next_scene(task: Task, random: np.random.Generator, options: dict[str, Any] | None) -> tuple[Scene, int]:
    """The next world of a sequence of episodes, and its seed."""
    drawn = int(random.integers(2**32))
    given = (options or {}).get("scene")
    scene = task.draw(drawn) if given is None else given.copy()
    task.place(scene)
    return scene, drawn
