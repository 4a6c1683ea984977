"""Evolution: CMA-ES for vectors of real numbers, and fitness of one individual at a time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ._native import CmaEs

__all__ = ["CmaEs", "OneByOne"]

Fitness = Callable[[NDArray[np.float64], int, int, int], float]
"""Function of a genome, the seed of the evolution, and the numbers of generation and individual, from 0."""


class OneByOne:
    """Fitness of a generation, as `CmaEs.step` calls it, by a function of one individual.

    `roverlab.ray.OneByOne` does the same on the machines of a cluster, with the same result.

    Parameters
    ----------
    fitness : callable
        Function ``fitness(genome, seed, generation, index)`` that returns a number and depends on nothing else, so
        that it does not matter where and how often it is called. ``genome`` is an array of shape (genes,).
    seed : int
        Seed of the evolution, which is passed on.
    generation : int
        Number of the first generation; that of an evolution that goes on is not 0.
    """

    def __init__(self, fitness: Fitness, seed: int = 1, generation: int = 0) -> None:
        self.fitness, self.seed = fitness, seed
        self.generation = generation
        """Number of the next generation."""

    def __call__(self, genomes: NDArray[np.float64]) -> NDArray[np.float64]:
        """Fitness of each individual of the next generation.

        Parameters
        ----------
        genomes : ndarray of float64, shape (individuals, genes)

        Returns
        -------
        ndarray of float64, shape (individuals,)
        """
        scores = np.array(self._scores(genomes), np.float64)
        self.generation += 1
        return scores

    def _scores(self, genomes: NDArray[np.float64]) -> list[float]:
        return scored(self.fitness, self.seed, self.generation, 0, genomes)


def scored(fitness: Fitness, seed: int, generation: int, first: int, genomes: NDArray[np.float64]) -> list[float]:
    """Fitness of some individuals of a generation, of which the first has a number."""
    return [float(fitness(genome, seed, generation, first + index)) for index, genome in enumerate(genomes)]
