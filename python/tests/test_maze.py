"""Mazes and their routes."""

from pathlib import Path

import numpy as np
import pytest

import roverlab
from roverlab.maze import Maze
from roverlab.sim import Simulation

TEXT = """\
o---o---o---o
|     G |   |
o   o---o   o
| S         |
o---o---o---o
"""


def test_a_text_is_read_solved_and_written(tmp_path: Path) -> None:
    maze = Maze.parse(TEXT)
    assert (maze.shape, maze.start, maze.goals, maze.defects) == ((2, 3), (0, 0), [(1, 1)], [])
    route = maze.shortest_route()
    assert route.cells.tolist() == [[0, 0], [1, 0], [1, 1]] and (route.steps, route.turns) == (2, 1)
    assert maze.distances().tolist() == [[2, 3, 4], [1, 0, 5]]
    (tmp_path / "maze.txt").write_text(str(maze))
    assert str(Maze.load(tmp_path / "maze.txt")) == str(maze) == str(Maze.parse(TEXT.encode()))
    assert maze.walls.shape == (2, 3, 4) and maze.walls[0, 0].tolist() == [False, False, True, True]
    for form in ("text", "maze"):
        again = Maze.parse(maze.to_text(form))
        assert np.array_equal(again.walls, maze.walls)


def test_routes_follow_the_flood_fill() -> None:
    for seed in range(5):
        maze = Maze.competition(16, seed)
        distances, route = maze.distances(), maze.shortest_route()
        assert distances[maze.start] == route.steps == len(route) == len(route.cells) - 1
        steps = [distances[tuple(cell)] for cell in route.cells]
        assert steps == list(range(route.steps, -1, -1))
        assert maze.shortest_route("turns").turns <= route.turns
    assert (Maze.braided(9, 7, 0.0, 1).distances() >= 0).all()


def test_a_maze_is_a_world() -> None:
    scene = Maze.competition(8, 2).to_scene(0.36)
    assert scene.start is not None and len(scene.walls) > 10
    scene.add_robot("S4")
    assert Simulation(scene, noise=0.0).robot().distance("left") < 0.36


def test_wrong_arguments_are_named(tmp_path: Path) -> None:
    maze = Maze.parse(TEXT)
    with pytest.raises(roverlab.FileFormatError, match="small:.*found .*; expected"):
        Maze.parse("nothing\x00", "small")
    with pytest.raises(FileNotFoundError, match="none.txt"):
        Maze.load(tmp_path / "none.txt")
    with pytest.raises(ValueError, match='preference is "luck"; expected steps, turns or both'):
        maze.shortest_route("luck")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match='format is "pdf"; expected text, maze'):
        maze.to_text("pdf")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="part is 2; expected 0 to 1"):
        Maze.braided(4, 4, 2.0, 1)
    with pytest.raises(ValueError, match="cell is 0; expected"):
        maze.to_scene(0.0)
    with pytest.raises(ValueError, match="seed is -1"):
        Maze.competition(8, -1)
    with pytest.raises(ValueError, match="expected"):
        Maze.competition(1000, 1)
    with pytest.raises(roverlab.NoPathError, match="no way leads"):
        Maze.parse(TEXT.replace("|     G |", "|   | G |")).shortest_route()
