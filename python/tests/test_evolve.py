"""Evolution."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from roverlab.evolve import CmaEs, OneByOne


def valley(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rosenbrock's function, whose optimum is at (1, 1)."""
    x, y = points.T
    return np.asarray(-((1.0 - x) ** 2) - 100.0 * (y - x * x) ** 2)


def test_a_valley_is_followed_and_runs_are_equal() -> None:
    first, second = (CmaEs([-1.0, 1.0], 0.5, 12, seed=3) for _ in range(2))
    assert first.best is None and first.history.shape == (0, 3)
    for _ in range(150):
        first.step(valley)
        second.step(lambda points: valley(points).tolist())
    assert first.best is not None and second.best is not None
    assert first.best[0] == pytest.approx([1.0, 1.0], abs=1e-3) and first.best[1] > -1e-6
    assert np.array_equal(first.history, second.history) and first.history.shape == (150, 3)
    assert np.array_equal(first.mean, second.mean) and first.sigma < 0.1
    assert (first.history[:, 0] >= first.history[:, 1]).all()


def test_wrong_fitness_is_named_and_changes_nothing() -> None:
    search: Any = CmaEs(np.zeros(3), 0.5)
    with pytest.raises(ZeroDivisionError):
        search.step(lambda points: 1 / 0)
    with pytest.raises(ValueError, match="fitness is 2 numbers; expected a sequence of 7 numbers"):
        search.step(lambda points: [1.0, 2.0])
    with pytest.raises(ValueError, match=r"fitness is an array of shape \(2,\); expected shape \(7,\)"):
        search.step(lambda points: np.zeros(2))
    with pytest.raises(TypeError, match="fitness is <class 'NoneType'>; expected a sequence"):
        search.step(lambda points: None)
    with pytest.raises(ValueError, match="fitness of individual 0 in generation 0 is NaN; expected a finite"):
        search.step(lambda points: np.full(7, np.nan))
    with pytest.raises(TypeError, match="fitness is <class 'int'>; expected a function"):
        search.step(1)
    assert search.best is None and len(search.history) == 0
    search.step(lambda points: -np.abs(points).sum(axis=1))
    assert len(search.history) == 1
    with pytest.raises(ValueError, match="individuals is 2; expected 4 to 10000"):
        CmaEs([0.0], 1.0, 2)
    with pytest.raises(ValueError, match="sigma is 0; expected a positive"):
        CmaEs([0.0], 0.0)


def test_individuals_are_evaluated_one_by_one() -> None:
    seen: list[tuple[int, int, int]] = []

    def fitness(genome: NDArray[np.float64], seed: int, generation: int, index: int) -> float:
        seen.append((seed, generation, index))
        if generation == 2:
            raise ZeroDivisionError
        return float(valley(genome[None])[0])

    one, all_of_them = (CmaEs([-1.0, 1.0], 0.5, 6, seed=3) for _ in range(2))
    each = OneByOne(fitness, seed=7)
    for _ in range(2):
        one.step(each)
        all_of_them.step(valley)
    assert np.array_equal(one.history, all_of_them.history) and each.generation == 2
    assert seen == [(7, generation, index) for generation in range(2) for index in range(6)]
    with pytest.raises(ZeroDivisionError):
        one.step(each)
    assert each.generation == 2 and len(one.history) == 2
