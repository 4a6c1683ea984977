"""Fitness by functions in Python, on a cluster."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from .. import evolve
from ._connection import connected
from ._worker import PIECE


class OneByOne(evolve.OneByOne):
    """`roverlab.evolve.OneByOne` on the machines of a Ray cluster, with the same result.

    Individuals are evaluated in pieces of about 50 ms. Ray asks a piece again whose machine is lost. A machine needs
    the modules that the function imports, and its own if that is not the main program. What the function raises is
    raised.

    Parameters
    ----------
    fitness : callable
        Function ``fitness(genome, seed, generation, index)`` that returns a number and depends on nothing else.
    seed : int
        Seed of the evolution, which is passed on.
    generation : int
        Number of the first generation.
    """

    def __init__(self, fitness: evolve.Fitness, seed: int = 1, generation: int = 0) -> None:
        super().__init__(fitness, seed, generation)
        self._ray = connected()
        self._function = self._ray.put(fitness)
        self._remote = self._ray.remote(timed).options(max_retries=-1)
        self._seconds = PIECE / 4

    def _scores(self, genomes: NDArray[np.float64]) -> list[float]:
        size = max(1, round(PIECE / self._seconds))
        own = (self._function, self.seed, self.generation)
        pieces = [
            self._remote.remote(*own, first, genomes[first : first + size]) for first in range(0, len(genomes), size)
        ]
        try:
            done = self._ray.get(pieces)
        finally:
            for piece in pieces:
                self._ray.cancel(piece)
        self._seconds = max(sum(seconds for _, seconds in done) / len(genomes), 1e-6)
        return [score for scores, _ in done for score in scores]


def timed(
    fitness: evolve.Fitness, seed: int, generation: int, first: int, genomes: NDArray[np.float64]
) -> tuple[list[float], float]:
    """The fitness of some individuals, and the time taken (s)."""
    start = time.perf_counter()
    # Arrays that arrive cannot be written to, unlike those of a local evolution.
    scores = evolve.scored(fitness, seed, generation, first, np.array(genomes))
    return scores, time.perf_counter() - start
