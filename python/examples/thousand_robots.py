"""1,000 robots follow the nearest wall, all in one call per step; the commands are arrays."""

import time

import numpy as np

from roverlab.sim import Batch, Scene

ROBOTS = 1000
STEPS = 200
PERIOD = 0.1


def main() -> None:
    scenes = []
    for seed in range(20):
        scene = Scene.room(seed)
        scene.add_robot("S4")
        scenes.append(scene)
    batch = Batch(scenes, copies=ROBOTS // len(scenes), scan=False, walls=True, threads=2)
    commands = np.empty((ROBOTS, 2))
    start = time.perf_counter()
    for _ in range(STEPS):
        front, left = batch.distances[:, 0], batch.distances[:, 1]
        # Along the wall on the left at 0.2 m; a turn to the right before a corner.
        commands[:, 1] = np.clip(4.0 * (np.minimum(left, 0.5) - 0.2), -1.0, 1.0)
        commands[front < 0.35, 1] = -1.5
        commands[:, 0] = np.where(front < 0.35, 0.05, 0.2)
        batch.step(commands, PERIOD)
    seconds = time.perf_counter() - start
    clean = batch.contacts == 0
    print(f"{ROBOTS * STEPS / seconds:,.0f} robot steps/s, {ROBOTS * STEPS * PERIOD / seconds:,.0f} times real time")
    print(
        f"{clean.mean():.0%} of the robots touched nothing; {batch.walls[clean, 0].mean():.2f} m from a wall on average"
    )


if __name__ == "__main__":
    main()
