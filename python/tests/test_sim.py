"""Scenes, simulations and their robots."""

import math
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import roverlab
from roverlab import nav, vision
from roverlab.drive import LaneKeeper, Racer
from roverlab.sim import RobotSpec, Scene, Simulation

WORLD = "floor 2000 1000\n0 0 2000 0\n0 1000 2000 1000\n"
MAZE = " _ _\n|_ S|\n"
MOVINGAI = "type octile\nheight 2\nwidth 3\nmap\n..@\n...\n"
ROS = "image: m.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
IMAGE = b"P5\n3 2\n255\n\xfe\xfe\x00\xfe\xfe\xfe"


@pytest.mark.parametrize(
    ("text", "name", "files", "walls", "robots"),
    [
        ("world r.wld\nS4 400 500 0\n", "r.sim", {"r.wld": WORLD.encode()}, 2, 1),
        (WORLD, "r.wld", {}, 2, 0),
        (MAZE, "r.maz", {}, None, 0),
        (MOVINGAI, "r.map", {}, None, 0),
        (ROS, "r.yaml", {"m.pgm": IMAGE}, None, 0),
        (ROS.encode(), "r.yml", {"m.pgm": IMAGE}, None, 0),
    ],
)
def test_every_format_is_read_from_text_and_from_disk(
    text: str | bytes, name: str, files: dict[str, bytes], walls: int | None, robots: int, tmp_path: Path
) -> None:
    parsed = Scene.parse(text, name, files)
    data = text.encode() if isinstance(text, str) else text
    for file, content in {**files, name: data}.items():
        (tmp_path / file).write_bytes(content)
    loaded = Scene.load(tmp_path / name)
    for scene in (parsed, loaded, Scene.load(str(tmp_path / name))):
        assert len(scene.robots) == robots
        assert len(scene.walls) == walls if walls else len(scene.walls) > 0
        assert np.array_equal(scene.walls, parsed.walls)


def test_a_broken_file_is_named_with_its_place(tmp_path: Path) -> None:
    with pytest.raises(roverlab.FileFormatError, match=r"x\.sim:2:\d+: found .*; expected .*"):
        Scene.parse("S4 400 500 0\nS4 400 many 0\n", "x.sim", {})
    with pytest.raises(FileNotFoundError, match=r"none\.wld does not exist"):
        Scene.load(tmp_path / "none.wld")
    assert any("lamp" in warning for warning in Scene.parse("lamp 1 2 3\n", "x.sim", {}).warnings)


def test_a_scene_is_built_piece_by_piece() -> None:
    scene = Scene.empty(3.0, 2.0)
    scene.add_wall((0.0, 1.0), np.array([3.0, 1.0]))
    assert scene.add_object("can", [1.0, 0.5, 0.0]) == 0
    spec = RobotSpec("labbot").with_lidar(180, math.pi, 5.0)
    assert (scene.add_robot("s4", (0.5, 0.5, 0.0)), scene.add_robot(spec, (2.0, 0.5, 3.0))) == (0, 1)
    assert scene.walls.tolist() == [[0.0, 1.0, 3.0, 1.0]]
    assert [name for name, _ in scene.robots] == ["S4", "LabBot"]
    assert scene.objects == [("can", (1.0, 0.5, 0.0))]
    other = scene.copy()
    other.goal = (1.0, 1.0)
    assert scene.goal is None and other.goal == (1.0, 1.0)
    assert [len(robot.scan()) for robot in Simulation(scene).robots] == [360, 180]
    assert scene.to_svg("A scene").startswith("<svg")
    free, origin = scene.free_cells(0.1, 0.1)
    assert free.dtype == bool and free.any() and not free.all() and len(origin) == 2


def test_every_built_in_robot_and_world_is_simulated() -> None:
    for name in RobotSpec.names():
        scene = Scene.empty(20.0, 20.0)
        scene.add_robot(name, (10.0, 10.0, 0.0))
        Simulation(scene).run(0.1)
    for name in Scene.names():
        Simulation(Scene.built_in(name)).run(0.1)


def test_random_worlds_depend_on_their_seed_alone() -> None:
    for draw in (Scene.room, Scene.course):
        assert np.array_equal(draw(3).walls, draw(3).walls)
        assert not np.array_equal(draw(3).walls, draw(4).walls)
    course = Scene.course(5, unreachable=1.0)
    assert course.goal is not None and course.reachable is False
    assert Scene.course(5).reachable


def test_a_robot_drives_senses_and_knows_odometry_only(simulation: Simulation) -> None:
    robot = simulation.robot()
    assert robot.distance("front") == pytest.approx(0.935, abs=0.01) == robot.distance("1")
    robot.set_speed(0.2)
    robot.wait(2.0)
    x, y, heading = robot.pose()
    assert 0.3 < x < 0.4 and (y, heading) == (0.0, 0.0) and robot.speed()[0] == pytest.approx(0.2, abs=0.01)
    assert simulation.truth.pose()[0] == pytest.approx(1.0 + x, abs=0.01)
    assert simulation.time == robot.time == 2.0
    robot.stop()
    robot.set_pose((5.0, 6.0, 0.0))
    assert robot.pose() == (5.0, 6.0, 0.0) and simulation.truth.pose()[1] == 1.0
    assert not hasattr(robot, "truth")
    image = robot.image(160, 120)
    assert image.shape == (120, 160, 3) and image.dtype == np.uint8
    assert robot.encoder(1) > 0


def test_manoeuvres_end(simulation: Simulation) -> None:
    robot = simulation.robot()
    robot.straight(0.3, 0.2)
    assert not robot.is_done and robot.remaining() > 0.2
    robot.wait_done()
    robot.turn(math.pi / 2, 1.0)
    robot.wait_done()
    robot.drive_to(0.2, 0.1, 0.1)
    robot.wait_done()
    robot.curve(0.1, 0.2, 0.1)
    robot.wait_done()
    assert robot.is_done and simulation.truth.contacts() == 0
    robot.straight(5.0, 0.3)
    robot.wait_done()
    assert robot.is_stalled and simulation.truth.contacts() == 1
    assert simulation.truth.contact_places().shape == (1, 2)


def test_scans_are_written_where_they_should_be(simulation: Simulation) -> None:
    robot, out = simulation.robot(), np.zeros(360)
    assert robot.scan(out) is out
    assert np.array_equal(out, robot.scan()) and (out > 0.9).all()
    wide = np.zeros((360, 2))
    robot.scan(wide[:, 1])
    assert np.array_equal(wide[:, 1], out) and not wide[:, 0].any()
    angles = robot.beam_angles()
    assert angles[0] == pytest.approx(-math.pi) and np.diff(angles) == pytest.approx(math.tau / 360)
    points = out * np.array([np.cos(angles), np.sin(angles)])
    assert np.abs(points).max(axis=0) == pytest.approx(1.0, abs=0.04)


def test_several_robots_and_trails(square: Scene) -> None:
    square.add_robot("S4", (0.5, 0.5, math.pi / 2))
    simulation = Simulation(square, seed=4, trail_interval=0.1)
    first, second = simulation.robots
    first.set_speed(0.1)
    second.set_speed(0.2, 0.5)
    simulation.run(3.0)
    assert len(simulation) == 2 and simulation.truth.path_length(1) > 1.5 * simulation.truth.path_length(0)
    trail = simulation.truth.trail(1)
    assert trail.shape == (30, 7) and tuple(trail[-1, 1:4]) == simulation.truth.pose(1)
    plan = np.array([[0.5, 0.5], [1.0, 1.0]])
    assert simulation.to_svg("Two", plan).count("<path") > simulation.to_svg().count("<path") - 1


GRAY, FREE = np.zeros((4, 4), np.uint8), np.ones((4, 4), np.bool_)
NEGATIVE: Any = -3
WRONG: list[tuple[type[Exception], str, Callable[[Scene, Simulation], object]]] = [
    (ValueError, "linear speed is NaN; expected", lambda _, w: w.robot().set_speed(math.nan)),
    (ValueError, "duration is .*; expected", lambda _, w: w.run(math.inf)),
    (ValueError, "duration is .*; expected", lambda _, w: w.run(1e7)),
    (ValueError, "speed is 0; expected", lambda _, w: w.robot().straight(1.0, 0.0)),
    (ValueError, 'sensor is "up"; expected front', lambda _, w: w.robot().distance("up")),
    (ValueError, "robot is 1; expected an index below 1", lambda _, w: w.robot(1)),
    (ValueError, "robot is -1; expected a whole number", lambda _, w: w.robot(-1)),
    (ValueError, "robot", lambda _, w: w.truth.pose(1)),
    (ValueError, "image size is 7 x 7; expected", lambda _, w: w.robot().image(7, 7)),
    (ValueError, "motor speed is 2; expected -1 to 1", lambda _, w: w.robot().set_motor(1, 2.0)),
    (ValueError, r"out is an array of shape \(3,\); expected shape \(360,\)", lambda _, w: w.robot().scan(np.zeros(3))),
    (roverlab.UnsupportedError, "the robot has no PSD 9", lambda _, w: w.robot().distance("9")),
    (ValueError, "noise is -1; expected", lambda s, _: Simulation(s, noise=-1.0)),
    (ValueError, "seed is -1; expected", lambda s, _: Simulation(s, seed=-1)),
    (ValueError, "trail interval is 0; expected", lambda s, _: Simulation(s, trail_interval=0.0)),
    (ValueError, 'name is "cat"; expected one of S4', lambda s, _: s.add_robot("cat")),
    (ValueError, "pose is None; expected x, y and heading", lambda s, _: s.add_robot("S4")),
    (ValueError, "pose is .*NaN.*; expected finite", lambda s, _: s.add_robot("S4", (0.0, math.nan, 0.0))),
    (ValueError, 'name is "cat"; expected one of can', lambda s, _: s.add_object("cat", (0.0, 0.0, 0.0))),
    (ValueError, "width is 0; expected", lambda *_: Scene.empty(0.0, 1.0)),
    (ValueError, "distance is 7; expected 0.05 to 1", lambda *_: Scene.room(1, 7.0)),
    (ValueError, "share of unreachable goals is 2", lambda *_: Scene.course(1, unreachable=2.0)),
    (ValueError, "resolution is 0; expected", lambda s, _: s.free_cells(0.0, 0.1)),
    (ValueError, 'name is "Mars"; expected one of', lambda *_: Scene.built_in("Mars")),
    (ValueError, "lidar points is 0; expected", lambda *_: RobotSpec("S4").with_lidar(0)),
    (ValueError, "seconds is -1; expected at least 0", lambda _, w: w.run(-1.0)),
    (ValueError, "seconds is -1; expected at least 0", lambda _, w: w.robot().wait(-1.0)),
    (ValueError, "width is -1; expected a whole number from 0 to", lambda _, w: w.robot().image(-1, 5)),
    (ValueError, "height is 4294967296; expected", lambda _, w: w.robot().image(320, 2**32)),
    (ValueError, "motor is 300; expected a whole number from 0 to 255", lambda _, w: w.robot().set_motor(300, 1.0)),
    (ValueError, "servo is 300; expected", lambda _, w: w.robot().set_servo(300, 0.0)),
    (ValueError, "motor is -1; expected", lambda _, w: w.robot().encoder(-1)),
    (ValueError, "beams is -1; expected a whole number", lambda *_: RobotSpec("S4").with_lidar(-1)),
    (ValueError, "obstacles is -1; expected", lambda *_: Scene.course(1, obstacles=(-1, 2))),
    (ValueError, "level is 256; expected a whole number from 0 to 255", lambda *_: vision.threshold(GRAY, 256)),
    (ValueError, "size is -3; expected a whole number", lambda *_: vision.gaussian(GRAY, NEGATIVE)),
    (ValueError, r"start is \(0, -1\); expected a row", lambda *_: nav.Planner(FREE).plan((0, -1), (1, 1))),
    (ValueError, r"goal is \(1, 1000000.*\); expected", lambda *_: nav.Planner(FREE).plan((0, 1), (1, 10**30))),
    (ValueError, r"path is an array of shape \(2, 3\)", lambda _, w: w.to_svg(path=np.zeros((2, 3)))),
]


@pytest.mark.parametrize(("kind", "message", "call"), WRONG, ids=[message[:30] for _, message, _ in WRONG])
def test_wrong_values_are_named(
    kind: type[Exception],
    message: str,
    call: Callable[[Scene, Simulation], object],
    square: Scene,
    simulation: Simulation,
) -> None:
    with pytest.raises(kind, match=message):
        call(square, simulation)


def test_wrong_types_and_arrays_are_named(square: Scene, simulation: Simulation) -> None:
    robot: Any = simulation.robot()
    scene: Any = square
    with pytest.raises(TypeError, match=r"out is an array of float32 of shape \(360,\); expected an array of float64"):
        robot.scan(np.zeros(360, np.float32))
    with pytest.raises(TypeError, match="out is <class 'list'>; expected an array"):
        robot.scan([0.0] * 360)
    fixed = np.zeros(360)
    fixed.flags.writeable = False
    with pytest.raises(ValueError, match="out is read-only; expected a writable array"):
        robot.scan(fixed)
    with pytest.raises(TypeError, match="spec is <class 'int'>; expected str or RobotSpec"):
        scene.add_robot(3)
    with pytest.raises(TypeError, match="text is <class 'float'>; expected str or bytes"):
        Scene.parse(1.0, "x.wld")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="linear"):
        robot.set_speed("fast")
    with pytest.raises(TypeError, match="seed"):
        Simulation(scene, seed=1.5)  # type: ignore[arg-type]


def test_robots_without_a_device_say_so() -> None:
    scene = Scene.empty(9.0, 9.0)
    scene.add_robot("SolarRaft", (4.0, 4.0, 0.0))
    robot = Simulation(scene).robot()
    calls: list[Callable[[], object]] = [robot.scan, robot.beam_angles, robot.image]
    for call in calls:
        with pytest.raises(roverlab.UnsupportedError, match="the robot has no"):
            call()


def test_other_threads_run_during_a_long_call(square: Scene) -> None:
    simulation, seen = Simulation(square), [0]

    def count() -> None:
        while seen[0] >= 0:
            seen[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before, start = seen[0], time.perf_counter()
    while time.perf_counter() - start < 0.3:
        simulation.run(10_000.0)
    counted, seen[0] = seen[0] - before, -10_000_000
    thread.join()
    assert counted > 20


def test_threads_may_share_a_simulation(square: Scene) -> None:
    simulation = Simulation(square)

    def work() -> None:
        for _ in range(50):
            simulation.run(10.0)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for _ in range(100):
        simulation.robot().scan()
    for thread in threads:
        thread.join()
    assert simulation.time == 2000.0


@pytest.mark.skipif(sys.platform == "win32", reason="signals of Unix")
@pytest.mark.parametrize("call", ["simulation.run(1e6)", "simulation.robot().wait(1e6)", "batch.step(still, 1e6)"])
def test_ctrl_c_ends_a_long_call(call: str) -> None:
    # A shell that runs the tests in the background has them ignore this signal.
    program = (
        "import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "import numpy\nfrom roverlab.sim import *\nscene = Scene.walled(2, 2)\n"
        "[scene.add_robot('S4', (0.2 + 0.02 * i, 1, 0)) for i in range(80)]\n"
        "simulation, batch, still = Simulation(scene), Batch(scene), numpy.zeros((80, 2))\n"
        f"print('go', flush=True)\n{call}\n"
    )
    process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    try:
        _, errors = process.communicate(timeout=20)
    finally:
        process.kill()
    assert b"KeyboardInterrupt" in errors


def test_no_memory_is_lost(square: Scene) -> None:
    resource = pytest.importorskip("resource")
    simulation = Simulation(square)
    robot, out = simulation.robot(), np.zeros(360)

    def work(times: int) -> int:
        for _ in range(times):
            robot.set_speed(0.1, 0.3)
            robot.wait(0.01)
            robot.scan(out)
            robot.scan()
            robot.pose()
        for _ in range(times // 100):
            Simulation(square).robot().scan()
        return int(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)

    before = work(5_000)
    assert work(50_000) - before < 8_000


def test_tracks_and_roads() -> None:
    track, road = Scene.track(3), Scene.road(3)
    for scene, names, width in ((track, {"cone-blue", "cone-yellow"}, (1.4, 3.0)), (road, set(), (0.17, 0.23))):
        line = scene.centre_line
        assert line is not None and scene.start is not None and line.shape[1] == 5
        assert names <= {name for name, _ in scene.objects}
        assert ((width[0] < line[:, 3:]) & (line[:, 3:] < width[1])).all()
        steps = np.roll(line[:, :2], -1, axis=0) - line[:, :2]
        angles = np.arctan2(steps[:, 1], steps[:, 0]) - line[:, 2]
        assert np.abs((angles + np.pi) % (2 * np.pi) - np.pi).max() < 0.3
    assert Scene.walled(1.0, 1.0).centre_line is None
    with pytest.raises(ValueError, match="pixel is 0; expected 0.001 to 0.1 m"):
        Scene.road(1, 0.0)


def test_cars_drive_by_their_behaviours() -> None:
    race, road = Scene.track(1), Scene.road(1)
    race.add_robot("RaceCar")
    road.add_robot("RoadCar")
    racing, keeping = Simulation(race), Simulation(road)
    racer, keeper = Racer(1), LaneKeeper(1.5)
    assert racer.run(racing.robot(), 120.0) == "the race is finished" == racer.outcome
    assert racing.truth.contacts() == 0 and racing.truth.path_length() > 200.0 and racer.period == 0.05
    keeper.run(keeping.robot(), 10.0)
    assert keeping.truth.path_length() > 10.0 and keeper.period == 0.03
    with pytest.raises(ValueError, match="speed is 0; expected a positive"):
        LaneKeeper(0.0)
    with pytest.raises(roverlab.UnsupportedError):
        Racer().decide(keeping.robot())
