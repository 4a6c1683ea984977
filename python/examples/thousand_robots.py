"""1,000 robots look for a wall and follow it, all in one call per step; the commands are arrays."""

import time

import numpy as np

from roverlab.sim import Batch, Scene

ROBOTS = 1000
STEPS = 600
PERIOD = 0.1
WANTED = 0.25  # Distance of the sensor on the left from the wall (m).


def main() -> None:
    scenes = []
    for seed in range(20):
        scene = Scene.room(seed)
        scene.add_robot("S4")
        scenes.append(scene)
    batch = Batch(scenes, copies=ROBOTS // len(scenes), scan=False, walls=True, threads=2)
    commands, found, near = np.zeros((ROBOTS, 2)), np.zeros(ROBOTS, bool), np.zeros(ROBOTS)
    last = batch.distances[:, 1].copy()
    start = time.perf_counter()
    for step in range(STEPS):
        front, left = batch.distances[:, 0], batch.distances[:, 1]
        # Straight ahead to a wall; then along it on the left, around its end too, and to the right before a corner.
        found |= np.minimum(front, left) < 0.4
        error, change = np.minimum(left, 0.6) - WANTED, np.minimum(left, 0.6) - np.minimum(last, 0.6)
        along = np.clip(2.0 * error + 1.2 * change / PERIOD, -0.8, 0.6)
        commands[:, 1] = np.where(front < 0.4, -1.5, np.where(found, along, 0.0))
        commands[:, 0] = np.where(front < 0.4, 0.03, 0.2)
        last[:] = left
        batch.step(commands, PERIOD)
        near += (step >= STEPS // 2) & (batch.walls[:, 0] < 0.6)
    seconds = time.perf_counter() - start
    print(f"{ROBOTS * STEPS / seconds:,.0f} robot steps/s, {ROBOTS * STEPS * PERIOD / seconds:,.0f} times real time")
    follow = (batch.contacts == 0) & (near > 0.45 * STEPS)
    print(f"{follow.mean():.0%} of the robots touched nothing and followed a wall in the second half of the time")


if __name__ == "__main__":
    main()
