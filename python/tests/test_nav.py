"""Planners and bugs."""

import math
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from roverlab.nav import Bug, DStarLite, NoPathError, Planner, distance_field, inflate
from roverlab.sim import Scene, Simulation

Method = Literal["dijkstra", "astar", "jps", "prepared_jps", "lazy_theta", "any_angle"]
OCTILE: list[Method] = ["dijkstra", "astar", "jps", "prepared_jps"]


def random_map(seed: int, rows: int = 12, columns: int = 17) -> NDArray[np.bool_]:
    free: NDArray[np.bool_] = np.random.default_rng(seed).random((rows, columns)) < 0.75
    free[0, 0] = free[-1, -1] = True
    return free


def cost(free: NDArray[np.bool_], method: Method) -> float:
    try:
        return Planner(free, method).plan((0, 0), (free.shape[0] - 1, free.shape[1] - 1)).cost
    except NoPathError:
        return math.inf


@given(st.integers(0, 2**32))
def test_all_planners_agree(seed: int) -> None:
    free = random_map(seed)
    octile = [cost(free, method) for method in OCTILE]
    assert octile == pytest.approx([octile[0]] * 4)
    shortest, short = cost(free, "any_angle"), cost(free, "lazy_theta")
    assert shortest <= short + 1e-9 and shortest <= octile[0] + 1e-9


@given(st.integers(0, 2**32))
def test_strides_do_not_matter(seed: int) -> None:
    free = random_map(seed)
    wide = np.repeat(np.repeat(free, 2, axis=0), 3, axis=1)[::2, ::3]
    for other in (np.asfortranarray(free), wide, free[::-1, ::-1][::-1, ::-1]):
        assert cost(other, "astar") == cost(free, "astar")
        assert np.array_equal(distance_field(other), distance_field(free))


def test_points_are_rows_and_columns() -> None:
    free = np.ones((3, 8), bool)
    free[0:2, 4] = False
    path = Planner(free).plan((0, 1), (0, 6))
    assert tuple(path.points[0]) == (0.5, 1.5) and tuple(path.points[-1]) == (0.5, 6.5)
    assert path.points[:, 0].max() == 2.5 and len(path) == len(path.points)
    length = np.linalg.norm(np.diff(path.points, axis=0), axis=1).sum()
    assert path.cost == pytest.approx(length) and 0 < path.expanded <= path.generated


@given(st.integers(0, 2**32))
def test_costs_of_cells(seed: int) -> None:
    free = random_map(seed)
    assert math.isclose(cost(free, "astar"), costly(np.where(free, 1.0, np.inf), "astar"), rel_tol=1e-4)
    costs = np.where(free, np.random.default_rng(seed).uniform(1.0, 5.0, free.shape), np.inf)
    assert costly(costs, "astar") == costly(costs, "dijkstra") >= cost(free, "astar") - 1e-3


def costly(costs: NDArray[np.float64], method: Method) -> float:
    try:
        return Planner(costs, method).plan((0, 0), (costs.shape[0] - 1, costs.shape[1] - 1)).cost
    except NoPathError:
        return math.inf


def test_dear_cells_are_gone_round() -> None:
    costs = np.ones((5, 5))
    costs[1:4, 2] = 50.0
    path = Planner(costs).plan((2, 0), (2, 4))
    assert {tuple(point) for point in path.points}.isdisjoint({(1.5, 2.5), (2.5, 2.5), (3.5, 2.5)})


@given(st.integers(0, 2**32))
def test_d_star_lite_repairs_what_a_star_would_find(seed: int) -> None:
    free = random_map(seed)
    planner, random = DStarLite(free, (0, 0), (11, 16)), np.random.default_rng(seed)
    for _ in range(4):
        row, column = random.integers(1, 11), random.integers(1, 16)
        free[row, column] = not free[row, column]
        planner.set_free((row, column), bool(free[row, column]))
        try:
            assert planner.plan().cost == pytest.approx(cost(free, "astar"))
        except NoPathError:
            assert cost(free, "astar") == math.inf


def test_distances_and_inflation() -> None:
    free = np.ones((5, 5), bool)
    free[2, 2] = False
    field = distance_field(free)
    assert field[2, 2] == 0.0 and field[2, 1] == 0.5 == field[0, 0] and field[1, 1] == math.sqrt(0.5)
    assert np.array_equal(inflate(free, 0.0), free)
    assert inflate(free, 0.6).sum() == 4
    assert inflate(free, 9.0).sum() == 0


def test_wrong_arguments_are_named() -> None:
    free: Any = np.ones((3, 4), bool)
    with pytest.raises(TypeError, match=r"grid is an array of float32 of shape \(3, 4\); expected an array of bool or"):
        Planner(free.astype(np.float32))
    with pytest.raises(TypeError, match=r"grid is an array of bool of shape \(12,\)"):
        Planner(free.ravel())
    with pytest.raises(TypeError, match="free is <class 'list'>"):
        distance_field([[True]])  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="cost of a cell is 0.5; expected 1 to 7000"):
        Planner(np.full((3, 4), 0.5))
    with pytest.raises(ValueError, match="cost of a cell is NaN"):
        Planner(np.full((3, 4), np.nan))
    with pytest.raises(ValueError, match='method is "jps"; expected dijkstra or astar'):
        Planner(np.ones((3, 4)), "jps")
    with pytest.raises(ValueError, match='method is "luck"; expected dijkstra, astar'):
        Planner(free, "luck")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"goal is \(3, 0\); expected a cell of the grid of 3 rows and 4 columns"):
        Planner(free).plan((0, 0), (3, 0))
    with pytest.raises(ValueError, match=r"start is \(-1, 0\); expected a row and a column of at least 0"):
        Planner(free).plan((-1, 0), (2, 0))
    free[:, 2] = False
    with pytest.raises(ValueError, match=r"goal is \(0, 2\), a blocked cell; expected a free cell"):
        Planner(free).plan((0, 0), (0, 2))
    with pytest.raises(NoPathError, match=r"no path leads from \(0, 0\) to \(2, 3\)"):
        Planner(free).plan((0, 0), (2, 3))
    with pytest.raises(ValueError, match="radius is -1"):
        inflate(free, -1.0)
    with pytest.raises(ValueError, match="the map is empty"):
        Planner(np.ones((0, 0), bool)).plan((0, 0), (0, 0))


@pytest.mark.parametrize("kind", ["DistBug", "TangentBug", "Bug2"])
def test_bugs_reach_goals(kind: str) -> None:
    scene = Scene.course(11)
    scene.add_robot("S4")
    assert scene.goal is not None and scene.start is not None
    simulation = Simulation(scene, seed=3)
    x, y, heading = scene.start
    dx, dy = scene.goal[0] - x, scene.goal[1] - y
    cos, sin = math.cos(heading), math.sin(heading)
    bug = Bug((cos * dx + sin * dy, cos * dy - sin * dx), kind)
    assert bug.run(simulation.robot()) == bug.outcome == "the goal is reached"
    x, y, _ = simulation.truth.pose()
    assert math.hypot(scene.goal[0] - x, scene.goal[1] - y) < 0.1 and simulation.truth.contacts() == 0


def test_bugs_refuse_nonsense() -> None:
    with pytest.raises(ValueError, match='kind is "Bugs Bunny"; expected one of Bug1'):
        Bug((1.0, 0.0), "Bugs Bunny")
    with pytest.raises(ValueError, match="robot radius is -1; expected"):
        Bug((1.0, 0.0), radius=-1.0)
    with pytest.raises(ValueError, match="goal"):
        Bug((math.nan, 0.0))
