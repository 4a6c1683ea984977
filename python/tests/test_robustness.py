"""Memory, threads, forks, and arrays that cannot be used."""

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from roverlab import vision
from roverlab.drive import WallFollower
from roverlab.nav import Planner, distance_field
from roverlab.sim import Batch, Scene, Simulation

CALLS = 1_000_000


def resident() -> int:
    """Memory of this process (bytes)."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_million_calls_leak_nothing(square: Scene) -> None:
    simulation = Simulation(square)
    robot, image = simulation.robot(), np.zeros((8, 8, 3), np.uint8)
    batch, commands, out = Batch(square, scan=False), np.zeros((1, 2)), np.empty(360)
    wrong = np.zeros((1, 3))

    def refused() -> None:
        try:
            batch.step(wrong, 0.1)
        except ValueError:
            pass

    works: list[tuple[Callable[[], object], int]] = [
        (robot.pose, CALLS // 4),
        (lambda: robot.scan(out), CALLS // 20),
        (robot.scan, CALLS // 20),
        (lambda: vision.gray(image), CALLS // 4),
        (lambda: batch.step(commands, 0.01), CALLS // 5),
        (lambda: batch.simulation().truth.pose(), CALLS // 10),
        (lambda: batch.reset(0, 1), CALLS // 50),
        (refused, CALLS // 10),
    ]
    assert sum(count for _, count in works) >= 0.95 * CALLS
    for work, _ in works:
        for _ in range(1000):
            work()
    before = resident()
    for work, count in works:
        for _ in range(count):
            work()
    # 16 bytes left by each call would be 16 MB.
    assert resident() - before < 4_500_000


def test_threads_share_a_world_and_step_their_own(square: Scene) -> None:
    shared, trouble = Simulation(square), []
    expected = Simulation(square, seed=5)
    expected.robot().set_speed(0.1, 0.3)
    expected.run(20.0)

    def drive() -> None:
        try:
            own = Simulation(square, seed=5)
            own.robot().set_speed(0.1, 0.3)
            for _ in range(200):
                own.run(0.1)
                shared.robot().scan()
                shared.run(0.01)
                shared.to_svg()
            assert own.truth.pose() == expected.truth.pose()
        except BaseException as error:
            trouble.append(error)

    threads = [threading.Thread(target=drive) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60.0)
    assert not trouble and shared.time == pytest.approx(8.0)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_forked_process_goes_on_alone(square: Scene) -> None:
    batch, commands = Batch(square, copies=8, threads=2), np.tile([0.1, 0.2], (8, 1))
    batch.step(commands, 1.0)
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            batch.step(commands, 1.0)
            os.write(writing, batch.true_poses.tobytes())
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as file:
        told = file.read()
    os.waitpid(child, 0)
    assert batch.times[0] == 1.0
    batch.step(commands, 1.0)
    assert told == batch.true_poses.tobytes()


def test_arrays_that_cannot_be_used_are_named(square: Scene) -> None:
    image: Any = np.zeros((6, 8), np.uint8)
    read_only = image.copy()
    read_only.flags.writeable = False
    free: Any = np.ones((4, 4), np.bool_)
    robot: Any = Simulation(square).robot()
    with pytest.raises(ValueError, match="out is read-only; expected"):
        vision.sobel(image, out=read_only)
    assert vision.sobel(read_only).shape == (6, 8)
    with pytest.raises(TypeError, match="image is an array of float64; expected an array of uint8"):
        vision.sobel(image.astype(float))
    with pytest.raises(TypeError, match="image is <class 'list'>; expected"):
        vision.sobel([[0]])  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="size of out is 3 x 8; expected 6 x 8, as the image"):
        vision.sobel(image, out=np.zeros((3, 8), np.uint8))
    # Arrays of any strides are read, and written to.
    assert np.array_equal(vision.sobel(image[:, ::2]), vision.sobel(image[:, ::2].copy()))
    target = np.ones((6, 16), np.uint8)[:, ::2]
    vision.sobel(image, out=target)
    assert np.array_equal(target, vision.sobel(image))
    with pytest.raises(TypeError, match=r"free is an array of int64 of shape \(4, 4\); expected"):
        distance_field(free.astype(np.int64))
    with pytest.raises(TypeError, match="grid is an array of uint8"):
        Planner(free.astype(np.uint8))
    with pytest.raises(TypeError, match="out is an array of float32"):
        robot.scan(np.zeros(360, np.float32))
    with pytest.raises(ValueError, match=r"out is an array of shape \(10,\); expected shape \(360,\)"):
        robot.scan(np.zeros(10))
    strided = np.zeros(720)[::2]
    assert robot.scan(strided) is strided and (strided > 0.0).all()


def test_a_map_too_large_for_memory_is_refused_before_it_is_copied() -> None:
    for value in (np.ones(1), np.ones(1, np.bool_)):
        grid: Any = np.broadcast_to(value, (100_000, 100_000))
        with pytest.raises(ValueError, match="100000 x 100000 cells; expected at most"):
            Planner(grid)


@pytest.mark.parametrize("drive", ["wait_done", "WallFollower"])
def test_other_threads_run_while_a_robot_drives(drive: str) -> None:
    scene = Scene.empty(1e6, 1e6) if drive == "wait_done" else Scene.room(1)
    scene.add_robot("S4", (1.0, 1.0, 0.0) if drive == "wait_done" else None)
    simulation, turns, over = Simulation(scene), [0], threading.Event()
    robot = simulation.robot()

    def count() -> None:
        while not over.wait(0.002):
            turns[0] += 1

    other = threading.Thread(target=count)
    other.start()
    before, start = turns[0], time.perf_counter()
    if drive == "wait_done":
        robot.straight(3000.0, 0.2)
        robot.wait_done()
    else:
        WallFollower().run(robot, 8000.0)
    seconds, during = time.perf_counter() - start, turns[0] - before
    over.set()
    other.join()
    assert seconds > 0.05 and during > 10.0 * seconds, (seconds, during)


@pytest.mark.skipif(sys.version_info < (3, 11), reason="no `operator.call`")
def test_ctrl_c_before_the_first_array_is_no_panic() -> None:
    code = """
import _thread, operator, signal
from roverlab.sim import Scene, Simulation
# A shell that runs the tests in the background has them ignore this signal.
signal.signal(signal.SIGINT, signal.default_int_handler)
scene = Scene.walled(2.0, 2.0)
scene.add_robot("S4", (1.0, 1.0, 0.0))
robot = Simulation(scene).robot()
try:
    # Python looks for signals between its own instructions, of which there is none between these calls.
    list(map(operator.call, [_thread.interrupt_main, robot.scan]))
except KeyboardInterrupt:
    print("interrupted")
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stdout == "interrupted\n", done.stderr
