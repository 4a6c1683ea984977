"""What the tests have in common."""

import pytest
from hypothesis import settings

from roverlab.sim import Scene, Simulation

settings.register_profile("same", database=None, deadline=None, derandomize=True, max_examples=60)
settings.load_profile("same")


@pytest.fixture
def square() -> Scene:
    """An S4 in the middle of a walled square of 2 m."""
    scene = Scene.walled(2.0, 2.0)
    scene.add_robot("S4", (1.0, 1.0, 0.0))
    return scene


@pytest.fixture
def simulation(square: Scene) -> Simulation:
    """The square without noise."""
    return Simulation(square, noise=0.0)
