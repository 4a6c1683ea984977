"""The package as a whole: its types, documentation and examples."""

import inspect
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

import roverlab
from roverlab import drive, evolve, log, maze, nav, sim, vision
from roverlab.drive import WallFollower
from roverlab.sim import Scene, Simulation

PROJECT = Path(__file__).parents[1]
EXAMPLES = sorted((PROJECT / "examples").glob("*.py"))


def run(*command: str) -> str:
    """Output of a program in Python. It runs elsewhere, as the package's source has no native part."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([sys.executable, *command], cwd=folder, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


NEEDED = {"cluster": "ray", "policy_gradient": "stable_baselines3", "train_wall_follower": "gymnasium"}
"""Extras that an example needs."""


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_examples_run_and_are_short(example: Path, tmp_path: Path) -> None:
    assert len(example.read_text().splitlines()) <= 60
    pytest.importorskip(NEEDED.get(example.stem, "roverlab"))
    assert run(str(example), str(tmp_path))


def test_the_notebook_shows_pictures() -> None:
    pytest.importorskip("gymnasium")
    book = json.loads((PROJECT / "examples" / "pictures.ipynb").read_text())
    names: dict[str, object] = {}
    pictures = 0
    for cell in book["cells"]:
        if cell["cell_type"] == "code":
            assert not cell["outputs"]
            *lines, last = "".join(cell["source"]).splitlines()
            exec("\n".join(lines), names)
            pictures += eval(last, names)._repr_svg_().startswith("<svg")
    assert pictures == 4


def test_there_are_examples() -> None:
    assert len(EXAMPLES) >= 6


def test_stubs_are_those_of_the_package() -> None:
    pytest.importorskip("mypy")
    pytest.importorskip("gymnasium")
    run("-m", "mypy.stubtest", "--mypy-config-file", str(PROJECT / "pyproject.toml"), "roverlab")


def test_types_are_consistent() -> None:
    pytest.importorskip("mypy")
    pytest.importorskip("gymnasium")
    files = [PROJECT / "tests", PROJECT / "examples", PROJECT / "benches"]
    configuration = str(PROJECT / "pyproject.toml")
    run("-m", "mypy", "--cache-dir", "/dev/null", "--config-file", configuration, *map(str, files))
    run("-m", "mypy", "--cache-dir", "/dev/null", "--config-file", configuration, "-p", "roverlab")


def test_everything_is_documented() -> None:
    for module in (roverlab, drive, evolve, log, maze, nav, sim, vision):
        assert module.__doc__
        for name in module.__all__:
            thing = getattr(module, name)
            if name.startswith("__") or inspect.ismodule(thing):
                continue
            assert thing.__doc__, name
            members = vars(thing) if inspect.isclass(thing) else {}
            for member, value in members.items():
                documented = member.startswith("_") or getattr(value, "__doc__", None)
                assert documented or member in ATTRIBUTES, f"{name}.{member}"


ATTRIBUTES = {"points", "cost", "expanded", "generated", "cells", "steps", "turns"}
"""Documented in the class that has them."""


def test_the_readme_s_program_runs() -> None:
    text = (PROJECT / "README.md").read_text()
    program = text.split("```python\n")[1].split("```")[0]
    assert len(run("-c", program).split()) == 6


def test_a_robot_is_followed() -> None:
    scene = Scene.walled(4.0, 2.0)
    scene.add_robot("S4", (1.0, 1.0, 0.0))
    scene.add_robot("S4", (0.5, 1.0, 0.0))
    simulation = Simulation(scene)
    leader, robot = simulation.robots
    leader.set_speed(0.15)
    follower = drive.Follower(gap=0.4)
    follower.run(robot, 15.0)
    (x, _, _), (behind, _, _) = simulation.truth.pose(0), simulation.truth.pose(1)
    assert x > 3.0 and x - behind == pytest.approx(0.4, abs=0.05) and follower.period == 0.1
    with pytest.raises(ValueError, match="gap is 0.1; expected at least"):
        drive.Follower(gap=0.1)


def test_a_wall_is_followed() -> None:
    scene = Scene.walled(2.0, 2.0)
    scene.add_robot("S4", (0.5, 1.7, 0.0))
    simulation = Simulation(scene)
    follower = WallFollower()
    assert follower.run(simulation.robot(), 30.0) is None and follower.outcome is None
    assert simulation.truth.contacts() == 0 and simulation.truth.path_length() > 3.0
    assert simulation.robot().time == pytest.approx(30.0, abs=0.05) and follower.period == 0.02
    with pytest.raises(ValueError, match='side is "up"; expected left or right'):
        WallFollower("up")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="speed is 0; expected a positive"):
        WallFollower(speed=0.0)
