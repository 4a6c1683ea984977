"""Many robots in one call."""

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
    batch.ranges.flags.writeable = False
    with pytest.raises(ValueError, match="ranges is read-only"):
        batch.step(np.zeros((4, 2)), 0.1)


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
