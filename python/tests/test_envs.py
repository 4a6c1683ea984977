"""Environments for Gymnasium."""

import warnings

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env  # noqa: E402

from roverlab import envs  # noqa: E402
from roverlab.sim import Scene  # noqa: E402

NAMES = ["roverlab/WallFollowing-v0", "roverlab/GoalReaching-v0"]


@pytest.mark.parametrize("name", NAMES)
def test_the_checker_passes(name: str) -> None:
    with warnings.catch_warnings():
        # It would have actions between -1 and 1; ours are in m/s and rad/s.
        warnings.filterwarnings("ignore", message=".*we recommend using a symmetric and normalized space.*")
        check_env(gymnasium.make(name).unwrapped)


@pytest.mark.parametrize("name", NAMES)
def test_a_seed_determines_an_episode(name: str) -> None:
    def episode(seed: int) -> list[list[float]]:
        env = gymnasium.make(name)
        observation, _ = env.reset(seed=seed)
        env.action_space.seed(1)
        rows = [observation.tolist()]
        for _ in range(50):
            observation, reward, terminated, _, _ = env.step(env.action_space.sample())
            rows.append([*observation.tolist(), reward])
            if terminated:
                observation, _ = env.reset()
                rows.append(observation.tolist())
        return rows

    assert episode(3) == episode(3) != episode(4)


@pytest.mark.parametrize(("name", "good", "mean"), [(NAMES[0], 18, 6.0), (NAMES[1], 20, 11.0)])
def test_the_baselines_score(name: str, good: int, mean: float) -> None:
    scores = envs.score(gymnasium.make(name), range(20))
    assert (scores > 0.0).sum() >= good and scores.mean() > mean
    random = np.random.default_rng(1)
    chance = envs.score(
        gymnasium.make(name), range(5), lambda _: random.uniform([0.0, -2.0], [0.3, 2.0]).astype(np.float32)
    )
    assert chance.mean() < 1.0


@pytest.mark.parametrize("name", NAMES)
def test_pictures_and_own_scenes(name: str) -> None:
    env = gymnasium.make(name, render_mode="svg", noise=0.0)
    scene = Scene.walled(3.0, 3.0)
    scene.add_robot("S4", (1.5, 0.3, 0.0))
    scene.goal = (1.8, 0.3)
    env.reset(seed=1, options={"scene": scene})
    for _ in range(10):
        _, reward, *_ = env.step(np.array([0.2, 0.0], np.float32))
    assert str(env.render()).startswith("<svg") and len(scene.robots) == 1
    assert env.unwrapped.simulation.truth.pose()[0] > 1.55


def test_the_goal_ends_an_episode() -> None:
    env = gymnasium.make(NAMES[1])
    scene = Scene.walled(3.0, 3.0)
    scene.add_robot("S4", (1.0, 1.0, 0.0))
    scene.goal = (1.5, 1.0)
    observation, _ = env.reset(seed=1, options={"scene": scene})
    assert observation[:2] == pytest.approx([0.5, 0.0])
    total, over = 0.0, False
    while not over:
        _, reward, over, truncated, facts = env.step(np.array([0.2, 0.0], np.float32))
        total += float(reward)
        assert not truncated
    assert total == pytest.approx(10.4, abs=0.03) and facts["contacts"] == 0


def test_wrong_arguments_are_named() -> None:
    with pytest.raises(ValueError, match="render_mode is 'rgb_array'; expected None or 'svg'"):
        envs.WallFollowing(render_mode="rgb_array")
    with pytest.raises(ValueError, match="period is 0; expected 0.01 to 1 s"):
        envs.GoalReaching(period=0)
    with pytest.raises(ValueError, match="the scene has no goal"):
        envs.GoalReaching().reset(options={"scene": Scene.room(1)})
