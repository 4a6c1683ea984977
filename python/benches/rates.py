"""Rates of the package, beside the Rust library and IR-SIM. Usage: rates.py [--processor] [FLEET]

FLEET is the rate that `cargo bench -p roverlab-python --bench fleet` prints, in robot steps per second. IR-SIM takes
part if it is installed. Each figure is the median of five rounds; with `--processor` in processor time, for a machine
that has other work.
"""

import importlib.util
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable

import numpy as np

from roverlab import vision
from roverlab.envs import ENVIRONMENTS, RobotVectorEnvironment, WallFollowing
from roverlab.nav import Planner
from roverlab.sim import Batch, RobotSpec, Scene, Simulation

PROCESSOR = "--processor" in sys.argv
clock = time.thread_time if PROCESSOR else time.perf_counter

ROOM = 4.0
BEAMS = 180


def scene(robots: int = 1) -> Scene:
    square = Scene.walled(ROOM, ROOM)
    for _ in range(robots):
        square.add_robot(RobotSpec("S4").with_lidar(BEAMS), (2.0, 2.0, 0.0))
    return square


def seconds(work: Callable[[], object], times: int) -> float:
    """Median time of one call."""
    rounds = []
    for _ in range(5):
        start = clock()
        for _ in range(times):
            work()
        rounds.append((clock() - start) / times)
    return statistics.median(rounds)


def one_robot() -> float:
    robot, out = Simulation(scene()).robot(), np.empty(BEAMS)

    def step() -> None:
        robot.set_speed(0.2, 0.5)
        robot.wait(0.1)
        robot.scan(out)

    return 1 / seconds(step, 20_000)


def batch(threads: int) -> float:
    worlds = Batch(scene(), copies=1000, threads=threads)
    commands = np.tile([0.2, 0.5], (1000, 1))
    return 1000 / seconds(lambda: worlds.step(commands, 0.1), 100)


def sobel() -> float:
    image = np.random.default_rng(1).integers(0, 256, (480, 640), np.uint8)
    out = np.empty_like(image)
    assert np.array_equal(vision.sobel(image, out=out), vision.sobel(image))
    return 1e6 * seconds(lambda: vision.sobel(image, out=out), 2000)


def planner(method: str) -> float:
    free = np.random.default_rng(1).random((1024, 1024)) < 0.8
    free[0, 0] = free[-1, -1] = True
    planner = Planner(free, method)  # type: ignore[arg-type]
    return 1e3 * seconds(lambda: planner.plan((0, 0), (1023, 1023)), 3)


def environment() -> float:
    env, action = WallFollowing(), np.array([0.0, 1.0], np.float32)
    env.reset(seed=1)
    return 1 / seconds(lambda: env.step(action), 5000)


def vector(name: str, count: int = 1000) -> tuple[float, float]:
    """Rate of an environment's worlds, and that of their batch alone. No episode ends meanwhile."""
    env = RobotVectorEnvironment(ENVIRONMENTS[name][0], count)
    env.reset(seed=1)
    # Turning on the spot touches nothing, and craft float without thrust.
    action = np.zeros(len(env.task.slowest), np.float32)
    action[1] = 0.0 if env.task.THRUSTERS else 0.3
    actions, commands = np.tile(action, (count, 1)), np.tile(action.astype(np.float64), (len(env.batch), 1))
    steps: list[float] = []
    alone: list[float] = []
    # In turns, so that other work of the machine meets both.
    while len(steps) < 10 or len(steps) < 400 and sum(steps) < 5.0:
        start = clock()
        env.batch.step(commands, env.period)
        middle = clock()
        env.step(actions)
        alone.append(middle - start)
        steps.append(clock() - middle)
    return count / statistics.median(steps), count / statistics.median(alone)


def importing() -> float:
    program = "import numpy, time; t = time.perf_counter(); import roverlab; print(time.perf_counter() - t)"
    command = [sys.executable, "-c", program]
    times = [float(subprocess.run(command, capture_output=True, check=True).stdout) for _ in range(9)]
    return 1e3 * statistics.median(times)


IR_SIM = f"""
world: {{height: {ROOM}, width: {ROOM}, step_time: 0.1, sample_time: 0.1, offset: [0, 0], collision_mode: unobstructed}}
robot:
  - kinematics: {{name: diff}}
    shape: {{name: circle, radius: 0.06}}
    state: [2, 2, 0]
    vel_max: [1, 3]
    sensors:
      - {{type: lidar2d, range_min: 0, range_max: 9.999, angle_range: 6.2831853, number: {BEAMS},
         noise: True, std: 0.01}}
obstacle:
  - shape: {{name: linestring, vertices: [[0, 0], [{ROOM}, 0], [{ROOM}, {ROOM}], [0, {ROOM}], [0, 0]]}}
    state: [0, 0, 0]
    unobstructed: True
"""


def ir_sim() -> float:
    import irsim  # type: ignore[import-not-found, import-untyped, unused-ignore]

    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "square.yaml")
        with open(file, "w") as text:
            text.write(IR_SIM)
        env = irsim.make(file, display=False, disable_all_plot=True, log_level="ERROR")
    action = np.array([[0.2], [0.5]])

    def step() -> None:
        env.step(action)
        assert len(env.get_lidar_scan()["ranges"]) == BEAMS

    return 1 / seconds(step, 300)


def main() -> None:
    given = [float(word) for word in sys.argv[1:] if word != "--processor"]
    # Threads have processor times of their own.
    cores = 1 if PROCESSOR else os.cpu_count() or 1
    one = one_robot()
    print(f"1 robot, {BEAMS} beams at 10 Hz: {one:,.0f} steps/s")
    if importlib.util.find_spec("irsim"):
        other = ir_sim()
        print(f"IR-SIM, the same: {other:,.0f} steps/s, 1 / {one / other:.0f}")
    rate = batch(1)
    fleet = f", {rate / given[0]:.2f} of the fleet in Rust" if given else ""
    print(f"1,000 robots in one call: {rate:,.0f} robot steps/s{fleet}")
    if cores > 1:
        both = batch(2)
        print(f"1,000 robots, 2 threads: {both:,.0f} robot steps/s, {both / rate:.2f} times that")
    print(f"Sobel on 640 x 480, with out: {sobel():.1f} us")
    for method in ("astar", "jps", "any_angle"):
        print(f"{method} on 1024 x 1024: {planner(method):.2f} ms")
    print(f"WallFollowing, one environment: {environment():,.0f} steps/s")
    for name in ENVIRONMENTS:
        rate, alone = vector(name)
        print(f"{name}, 1,000 in a vector: {rate:,.0f} steps/s, {alone / rate - 1:+.0%} of the time of their batch")
    print(f"import, after numpy: {importing():.1f} ms")


if __name__ == "__main__":
    main()
