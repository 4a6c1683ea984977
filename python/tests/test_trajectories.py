"""Runs in Python are those in Rust, to the bit; `trajectories.rs` has computed the digests."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from roverlab.sim import Batch, Scene, Simulation

TABLE = Path(__file__).with_name("trajectories.txt").read_text().split("\n")[:-1]
DIGESTS = {int(seed): digest for seed, digest in (line.split() for line in TABLE)}


class Digest:
    """FNV-1a over words of 64 bits."""

    def __init__(self) -> None:
        self.state = 0xCBF29CE484222325

    def add(self, values: NDArray[np.float64] | tuple[float, ...]) -> None:
        for word in np.asarray(values, np.float64).view(np.uint64).tolist():
            self.state = ((self.state ^ word) * 0x100000001B3) % 2**64

    def __str__(self) -> str:
        return f"{self.state:016x}"


def two_robots(seed: int) -> Scene:
    scene = Scene.room(seed)
    assert scene.start is not None
    x, y, _ = scene.start
    scene.add_robot("S4")
    scene.add_robot("S4", (x, y + 0.3, 1.0))
    return scene


def turn(ranges: NDArray[np.float64]) -> float:
    return min(float(ranges[270]), 1.0) - min(float(ranges[90]), 1.0)


@pytest.mark.parametrize("seed", sorted(DIGESTS))
def test_a_simulation_is_the_same_in_both(seed: int) -> None:
    simulation = Simulation(two_robots(seed), seed=seed)
    digest = Digest()
    for _ in range(200):
        for robot in simulation.robots:
            ranges = robot.scan()
            ahead, *others = (robot.distance(name) for name in ("front", "left", "right", "back"))
            digest.add(ranges)
            digest.add((ahead, *others))
            digest.add(robot.pose())
            robot.set_speed(0.2 * min(ahead, 1.0), turn(ranges))
            digest.add(simulation.truth.pose(robot.index))
        simulation.run(0.1)
    assert str(digest) == DIGESTS[seed]


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_a_batch_is_the_same_in_both(threads: int) -> None:
    seeds = sorted(DIGESTS)
    batch = Batch([two_robots(seed) for seed in seeds], seed=seeds[0], threads=threads)
    digests, commands = [Digest() for _ in seeds], np.empty((len(batch), 2))
    for _ in range(200):
        for row in range(len(batch)):
            digest, ranges, ahead = digests[row // 2], batch.ranges[row], float(batch.distances[row, 0])
            for values in (ranges, batch.distances[row], batch.poses[row], batch.true_poses[row]):
                digest.add(values)
            commands[row] = 0.2 * min(ahead, 1.0), turn(ranges)
        batch.step(commands, 0.1)
    assert [str(digest) for digest in digests] == [DIGESTS[seed] for seed in seeds]
