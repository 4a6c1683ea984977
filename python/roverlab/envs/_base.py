"""What the environments have in common."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from ..sim import Robot, Scene, Simulation

Observation = NDArray[np.float32]
Action = NDArray[np.float32]

FARTHEST = 10.0
"""Distance that stands for a range without a return (m)."""

LOWEST = np.array([0.0, -2.0], np.float32)
"""Lowest linear (m/s) and angular speed (rad/s) of an action."""
HIGHEST = np.array([0.3, 2.0], np.float32)
"""Highest linear (m/s) and angular speed (rad/s) of an action."""


class RobotEnvironment(gymnasium.Env[Observation, Action]):
    """An S4 in a random world, commanded by linear and angular speed."""

    metadata = {"render_modes": ["svg"], "render_fps": 10}

    simulation: Simulation
    robot: Robot
    scene: Scene

    def __init__(self, render_mode: str | None, noise: float, period: float) -> None:
        if render_mode not in (None, "svg"):
            raise ValueError(f"render_mode is {render_mode!r}; expected None or 'svg'")
        if not 0.01 <= period <= 1.0:
            raise ValueError(f"period is {period}; expected 0.01 to 1 s")
        self.render_mode = render_mode
        self.noise = noise
        self.period = period
        self.action_space = gymnasium.spaces.Box(LOWEST, HIGHEST)

    @abstractmethod
    def _draw_scene(self, seed: int) -> Scene:
        """A random world with a start."""

    @abstractmethod
    def _observe(self) -> Observation:
        """What the robot senses now."""

    @abstractmethod
    def _judge(self) -> tuple[float, bool]:
        """Reward of the last step, and whether the episode is over."""

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
        drawn = int(self.np_random.integers(2**32))
        given = (options or {}).get("scene")
        self.scene = self._draw_scene(drawn) if given is None else given.copy()
        if not self.scene.robots:
            self.scene.add_robot("S4")
        trail = 0.1 if self.render_mode else None
        self.simulation = Simulation(self.scene, seed=drawn, noise=self.noise, trail_interval=trail)
        self.robot = self.simulation.robot()
        self._begin()
        return self._observe(), self._facts()

    @abstractmethod
    def _begin(self) -> None:
        """Sets what the reward of the first step is relative to."""

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Drives at the action's linear (m/s) and angular speed (rad/s) for one period."""
        linear, angular = np.clip(action, LOWEST, HIGHEST)
        self.robot.set_speed(linear, angular)
        self.robot.wait(self.period)
        reward, terminated = self._judge()
        return self._observe(), reward, terminated, False, self._facts()

    def render(self) -> str | None:
        """Picture of the world and the way so far, as the text of an SVG file."""
        return self.simulation.to_svg() if self.render_mode == "svg" else None

    def _facts(self) -> dict[str, Any]:
        truth = self.simulation.truth
        return {"pose": truth.pose(), "contacts": truth.contacts(), "time": self.simulation.time}
