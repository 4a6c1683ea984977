"""Many robots in one call."""

import signal
import subprocess
import sys
import warnings
from typing import Any

import numpy as np
import pytest

from roverlab.sim import Batch, RobotSpec, Scene, Simulation


def crowd() -> Scene:
    scene = Scene.walled(4.0, 4.0)
    for place in range(4):
        scene.add_robot("S4", (0.5 + place, 1.0, 0.5 * place))
    return scene


def test_rows_are_robots_and_arrays_stay_the_same() -> None:
    batch = Batch(crowd(), copies=3, seed=7)
    assert (len(batch), batch.worlds) == (12, 3)
    arrays = batch.ranges, batch.distances, batch.poses, batch.speeds, batch.stalled, batch.true_poses, batch.contacts
    assert [array.shape for array in arrays] == [(12, 360), (12, 4), (12, 3), (12, 2), (12,), (12, 3), (12,)]
    places = [array.ctypes.data for array in arrays]
    before = batch.ranges.copy()
    batch.step(np.full((12, 2), 0.2), 0.5)
    again = batch.ranges, batch.distances, batch.poses, batch.speeds, batch.stalled, batch.true_poses, batch.contacts
    assert [array.ctypes.data for array in again] == places
    assert (batch.ranges != before).any(axis=1).all() and (batch.poses[:, 0] > 0.02).all()
    assert batch.times == [0.5] * 3


def test_each_world_is_a_simulation_of_its_own() -> None:
    batch = Batch(crowd(), copies=2, seed=7)
    commands = np.random.default_rng(1).uniform(-0.2, 0.2, (8, 2))
    simulations = [Simulation(crowd(), seed=seed) for seed in (7, 8)]
    for simulation in simulations:
        for robot in simulation.robots:
            robot.scan()
            [robot.distance(name) for name in ("front", "left", "right", "back")]
    for _ in range(5):
        batch.step(commands, 0.1)
        for world, simulation in enumerate(simulations):
            for robot in simulation.robots:
                robot.set_speed(*commands[4 * world + robot.index])
            simulation.run(0.1)
            for robot in simulation.robots:
                row = 4 * world + robot.index
                assert np.array_equal(robot.scan(), batch.ranges[row])
                assert robot.distance("front") == batch.distances[row, 0]
                [robot.distance(name) for name in ("left", "right", "back")]
                assert robot.pose() == tuple(batch.poses[row])
                assert simulation.truth.pose(robot.index) == tuple(batch.true_poses[row])


def test_a_world_begins_again() -> None:
    batch = Batch(crowd(), copies=2, seed=7)
    start, others = batch.ranges[:4].copy(), batch.ranges[4:]
    batch.step(np.full((8, 2), 0.2), 1.0)
    kept = others.copy()
    batch.reset(0, 7)
    assert np.array_equal(batch.ranges[:4], start) and np.array_equal(batch.ranges[4:], kept)
    assert batch.times == [0.0, 1.0] and not batch.poses[:4].any()
    other = crowd()
    other.add_wall((2.0, 0.0), (2.0, 4.0))
    batch.reset(1, 9, other)
    assert not np.array_equal(batch.ranges[4:], start)


def test_commands_of_any_strides() -> None:
    batches = [Batch(crowd(), seed=1) for _ in range(3)]
    commands = np.arange(8.0).reshape(4, 2) / 20
    arrangements = (commands, np.asfortranarray(commands), np.repeat(commands, 2, axis=1)[:, ::2])
    for batch, given in zip(batches, arrangements, strict=True):
        batch.step(given, 0.3)
        assert np.array_equal(batch.true_poses, batches[0].true_poses)


def test_long_steps_are_the_same_as_short_ones() -> None:
    whole, parts = Batch(crowd(), copies=250, scan=False), Batch(crowd(), copies=250, scan=False, threads=3)
    commands = np.tile([0.1, 0.2], (1000, 1))
    whole.step(commands, 20.0)
    for _ in range(2):
        parts.step(commands, 10.0)
    whole.step(commands, 0.0)
    assert whole.times == parts.times
    assert np.array_equal(whole.true_poses, parts.true_poses) and np.array_equal(whole.contacts, parts.contacts)


def test_without_scans_there_are_no_ranges() -> None:
    scene = Scene.walled(2.0, 2.0)
    scene.add_robot(RobotSpec("S4").with_lidar(10), (0.5, 0.5, 0.0))
    scene.add_robot("S4", (1.5, 1.5, 0.0))
    batch = Batch(scene, scan=False)
    batch.step(np.zeros((2, 2)), 0.1)
    assert batch.ranges.shape == (2, 0)
    with pytest.raises(ValueError, match="number of beams of a robot is 360; expected 10"):
        Batch(scene)


def test_wrong_arguments_are_named() -> None:
    batch: Any = Batch(crowd())
    with pytest.raises(ValueError, match=r"commands is an array of shape \(3, 2\); expected shape \(4, 2\)"):
        batch.step(np.zeros((3, 2)), 0.1)
    with pytest.raises(TypeError, match=r"commands is an array of int64 of shape \(4, 2\); expected"):
        batch.step(np.zeros((4, 2), np.int64), 0.1)
    with pytest.raises(ValueError, match=r"commands\[2, 1\] is NaN; expected a finite"):
        batch.step(np.array([[0.1, 0.1], [0.1, 0.1], [0.1, np.nan], [0.1, 0.1]]), 0.1)
    with pytest.raises(ValueError, match="seconds is inf; expected a finite"):
        batch.step(np.zeros((4, 2)), np.inf)
    assert batch.times == [0.0] and not batch.poses.any()
    with pytest.raises(ValueError, match="world is 1; expected an index below 1"):
        batch.reset(1, 1)
    with pytest.raises(ValueError, match="scene is 1 robots of 360 beams; expected 4 robots"):
        small = Scene.walled(1.0, 1.0)
        small.add_robot("S4", (0.5, 0.5, 0.0))
        batch.reset(0, 1, small)
    with pytest.raises(ValueError, match="threads is 0; expected at least 1"):
        Batch(crowd(), threads=0)
    with pytest.raises(ValueError, match="number of robots is 0"):
        Batch(Scene.walled(1.0, 1.0))
    with pytest.raises(TypeError, match="scenes is <class 'int'>; expected Scene or a sequence"):
        Batch([1])  # type: ignore[list-item]
    with pytest.raises(ValueError, match="speeds is in use"):
        batch.step(batch.speeds, 0.1)
    with pytest.raises(ValueError, match="seconds is -5; expected a finite number from 0"):
        batch.step(np.zeros((4, 2)), -5.0)


@pytest.mark.parametrize("copies", [10**6, 2**61, 2**63, 10**18, 10**30])
def test_a_batch_of_too_many_robots_is_refused(copies: int) -> None:
    # Twice 2**63 would wrap to none.
    for scenes in (crowd(), [crowd(), crowd()]):
        with pytest.raises(ValueError, match=f"copies is {copies}; expected "):
            Batch(scenes, copies=copies)
    with pytest.raises(ValueError, match=r"copies is 250001; expected at most 250000, for 4 robots of 16 numbers"):
        Batch(crowd(), copies=250_001, scan=False)


def test_commands_to_thrusters_are_checked_before_any_world_steps() -> None:
    scene = Scene.pool(1)
    scene.add_robot("Mako")
    batch = Batch(scene, copies=3, space=True, thrusters=True)
    commands = np.full((3, 4), 0.5)
    commands[2, 1] = 1.5
    with pytest.raises(ValueError, match=r"commands\[2, 1\] is 1.5; expected -1 to 1"):
        batch.step(commands, 1.0)
    assert batch.times == [0.0] * 3
    with pytest.raises(ValueError, match=r"commands\[2, 1\] is NaN; expected -1 to 1"):
        batch.step(np.where(commands > 1.0, np.nan, commands), 1.0)


def test_arrays_of_a_batch_keep_their_size_and_type() -> None:
    batch, commands = Batch(crowd()), np.zeros((4, 2))
    with pytest.raises(ValueError, match="resize"):
        batch.ranges.resize((1, 1))
    with pytest.raises(ValueError, match="resize"):
        batch.stalled.resize((1000,), refcheck=False)
    view: Any = batch.ranges
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        view.dtype = np.float32
    batch.step(commands, 0.1)
    assert batch.ranges.dtype == np.float64 and batch.ranges.shape == (4, 360) and (batch.ranges > 0.0).all()
    base: Any = batch.poses.base
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        base.dtype = np.float32
    with pytest.raises(ValueError, match="poses is altered; expected"):
        batch.step(commands, 0.1)


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="the system has no such timer")
def test_a_handler_of_a_signal_is_told_that_the_batch_is_in_a_step() -> None:
    # In a program of its own, which a deadlock cannot hold.
    code = """
import signal
import numpy as np
from roverlab.sim import Batch, Scene
scene = Scene.walled(2.0, 2.0)
scene.add_robot("S4", (1.0, 1.0, 0.0))
batch, seen = Batch(scene, copies=50), []
def handler(*_):
    try:
        batch.times
    except RuntimeError as error:
        seen.append(str(error))
signal.signal(signal.SIGALRM, handler)
signal.setitimer(signal.ITIMER_REAL, 0.05)
while not seen:
    batch.step(np.zeros((50, 2)), 1000.0)
print(seen[0], batch.times[0] % 1000.0)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stdout.startswith("the batch is in the midst of a step; expected no use of it"), done.stderr
    assert done.stdout.endswith(" 0.0\n")


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_batch_takes_the_threads_that_there_can_be() -> None:
    code = """
import resource
import numpy as np
from roverlab.sim import Batch, Scene
scene = Scene.walled(2.0, 2.0)
scene.add_robot("S4", (1.0, 1.0, 0.0))
one, many = (Batch(scene, copies=16, threads=threads) for threads in (1, 16))
commands = np.full((16, 2), 0.1)
one.step(commands, 0.5)
with open("/proc/self/statm") as file:
    size = int(file.read().split()[0]) * resource.getpagesize()
# Not enough for the stack of a thread.
resource.setrlimit(resource.RLIMIT_AS, (size + 1_000_000, size + 1_000_000))
many.step(commands, 0.5)
print(np.array_equal(one.true_poses, many.true_poses))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stdout == "True\n", done.stderr


def test_a_world_of_a_batch_is_a_simulation() -> None:
    batch = Batch(crowd(), copies=2, seed=7, trail_interval=0.1)
    world = batch.simulation(1)
    batch.step(np.full((8, 2), 0.2), 1.0)
    assert world.time == 1.0 and world.truth.pose(2) == tuple(batch.true_poses[6])
    assert len(world.truth.trail(2)) == 10 and world.to_svg().startswith("<svg")
    world.run(0.5)
    assert batch.times == [1.0, 1.5]
    batch.reset(1, 8)
    assert world.time == 1.5 and batch.simulation(1).time == 0.0
    with pytest.raises(ValueError, match="world is 2; expected an index below 2"):
        batch.simulation(2)


def test_the_nearest_walls() -> None:
    scene = Scene.walled(2.0, 3.0)
    scene.add_robot("S4", (0.5, 1.0, 0.0))
    batch = Batch([scene, Scene.copy(scene)], walls=True)
    assert batch.walls == pytest.approx(np.array([[0.495, -1.0, 0.0]] * 2))
    batch.step(np.tile([0.2, 0.0], (2, 1)), 4.0)
    assert batch.walls[0] == pytest.approx([1.995 - batch.true_poses[0, 0], 1.0, 0.0], abs=1e-9)
    assert Batch(scene).walls.shape == (1, 0)
    open_floor = Scene.empty(1.0, 1.0)
    open_floor.add_robot("S4", (0.5, 0.5, 0.0))
    assert Batch(open_floor, walls=True).walls.tolist() == [[np.inf, 0.0, 0.0]]


def test_robots_on_centre_lines() -> None:
    road = Scene.road(2, None)
    line = road.centre_line
    assert line is not None
    x, y, heading = line[10, :3]
    road.add_robot("S4", (x - 0.02 * np.sin(heading), y + 0.02 * np.cos(heading), heading + 0.1))
    batch = Batch(road, noise=0.0, scan=False, ahead=(0.0, 0.5))
    spacing = np.hypot(*(np.roll(line[:, :2], -1, axis=0) - line[:, :2]).T).mean()
    along, length, left, turn, edge, *points = batch.lanes[0]
    assert [along, length] == pytest.approx([10 * spacing, len(line) * spacing])
    assert [left, turn, edge] == pytest.approx([0.02, 0.1, line[10, 4] - 0.02])
    assert points[:2] == pytest.approx([-0.02 * np.sin(0.1), -0.02 * np.cos(0.1)]) and 0.3 < points[2] < 0.55
    batch.step(np.array([[0.5, 0.0]]), 0.5)
    assert batch.lanes[0, 0] - along == pytest.approx(0.2, abs=0.06)
    assert Batch(road, scan=False).lanes.shape == (1, 0)
    with pytest.raises(ValueError, match="centre line of a scene is None; expected one"):
        Batch(crowd(), ahead=())
    with pytest.raises(ValueError, match="ahead is -1; expected distances of 0 to 1000000 m"):
        Batch(road, ahead=[1.0, -1.0])
