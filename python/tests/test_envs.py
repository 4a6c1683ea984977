"""Environments for Gymnasium."""

import warnings

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.vector import AutoresetMode, SyncVectorEnv  # noqa: E402

from roverlab import envs  # noqa: E402
from roverlab.sim import Scene  # noqa: E402

NAMES = list(envs.ENVIRONMENTS)
WALL, GOAL, MAZE, SWARM, RACE, LANE, HILL, DIVE = NAMES


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


@pytest.mark.parametrize(
    ("name", "episodes", "good", "mean"),
    [
        (WALL, 20, 18, 6.0),
        (GOAL, 20, 20, 11.0),
        (MAZE, 20, 20, 33.0),
        (SWARM, 20, 20, 500.0),
        (RACE, 10, 10, 300.0),
        (LANE, 5, 5, 120.0),
        (HILL, 20, 18, 0.15),
        (DIVE, 10, 10, 450.0),
    ],
)
def test_the_baselines_score(name: str, episodes: int, good: int, mean: float) -> None:
    scores = envs.score(gymnasium.make(name), range(episodes))
    assert (scores > 0.0).sum() >= good and scores.mean() > mean
    random = np.random.default_rng(1)
    env = gymnasium.make(name)
    space = env.action_space
    chance = envs.score(env, range(5), lambda _: random.uniform(space.low, space.high).astype(np.float32))
    assert chance.mean() < 0.2 * mean


@pytest.mark.parametrize("name", [WALL, GOAL])
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
    env = gymnasium.make(GOAL)
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


@pytest.mark.parametrize("name", NAMES)
def test_worlds_of_a_vector_run_as_environments_do(name: str) -> None:
    vector = gymnasium.make_vec(name, num_envs=4, threads=2, max_episode_steps=30, render_mode="svg")
    single = SyncVectorEnv([lambda: gymnasium.make(name, max_episode_steps=30)] * 4)
    assert vector.metadata["autoreset_mode"] == AutoresetMode.NEXT_STEP
    vector.action_space.seed(1)
    for reset in ({"seed": 5}, {"seed": [9, 8, 7, 6]}, {}):
        observation, facts = vector.reset(**reset)
        assert observation in vector.observation_space and facts["pose"].shape == (4, 3)
        assert np.array_equal(observation, single.reset(**reset)[0])
        ended = 0
        for _ in range(80):
            actions = vector.action_space.sample()
            done, expected = vector.step(actions), single.step(actions)
            for found, wanted in zip(done[:4], expected[:4], strict=True):
                assert np.array_equal(found, wanted)
            ended += int((done[2] | done[3]).sum())
        assert ended >= 8
    pictures = vector.render()
    assert pictures is not None and len(pictures) == 4 and all(text.startswith("<svg") for text in pictures)


def test_a_vector_without_copies_writes_into_the_same_array() -> None:
    vector = gymnasium.make_vec(WALL, num_envs=2, copy=False)
    first, _ = vector.reset(seed=1)
    assert vector.step(vector.action_space.sample())[0] is first
    copying = gymnasium.make_vec(WALL, num_envs=2)
    first, _ = copying.reset(seed=1)
    assert copying.step(vector.action_space.sample())[0] is not first


def test_each_cell_of_a_maze_counts_once() -> None:
    env = gymnasium.make(MAZE, noise=0.0)
    scene = Scene.walled(1.2, 0.4)
    scene.add_robot("S4", (0.2, 0.2, 0.0))
    observation, _ = env.reset(seed=1, options={"scene": scene})
    # Behind and on both sides there is no cell.
    assert observation[6:].tolist() == [0.0, 1.0, 1.0, 1.0]
    rewards, over = [], False
    while not over:
        _, reward, over, _, facts = env.step(np.array([0.2, 0.0], np.float32))
        rewards.append(float(reward))
    assert [reward for reward in rewards if reward] == [1.0, 11.0] and facts["time"] == pytest.approx(3.0, abs=0.3)
    far = Scene.walled(40.0, 1.0)
    far.add_robot("S4", (0.2, 0.2, 0.0))
    with pytest.raises(ValueError, match="the scene's bounds are .*; expected cells of 0.4 m"):
        env.reset(options={"scene": far})


def test_a_leader_can_be_lost() -> None:
    env = gymnasium.make(SWARM)
    env.reset(seed=1)
    rewards, over = [], False
    while not over:
        _, reward, over, _, _ = env.step(np.array([0.0, 0.0], np.float32))
        rewards.append(float(reward))
    assert rewards[0] > 0.9 and rewards[-2] == 0.0 and rewards[-1] == -10.0
    with pytest.raises(ValueError, match="the scene has 1 robots; expected a leader and a follower"):
        lonely = Scene.walled(2.0, 2.0)
        lonely.add_robot("S4", (1.0, 1.0, 0.0))
        env.reset(options={"scene": lonely})


@pytest.mark.parametrize(("name", "width"), [(RACE, 0.7), (LANE, 0.17)])
def test_ways_along_tracks(name: str, width: float) -> None:
    env = gymnasium.make(name, noise=0.0)
    observation, _ = env.reset(seed=1)
    line = env.unwrapped.scene.centre_line
    assert abs(observation[2]) < 0.3 and abs(observation[3]) < 0.1 and observation[4] > observation[5]
    total, over, before = 0.0, False, env.unwrapped.simulation.truth.pose()
    while not over:
        # Straight on, off the track at a bend.
        observation, reward, over, _, facts = env.step(np.array([1.0, 0.0], np.float32))
        total += float(reward)
        if not over:
            gone = float(np.hypot(facts["pose"][0] - before[0], facts["pose"][1] - before[1]))
            assert total == pytest.approx(gone, rel=0.15, abs=0.1)
    assert reward == -10.0 and abs(observation[2]) > width and len(line) > 100
    scene = Scene.walled(5.0, 5.0)
    scene.add_robot("RaceCar" if name == RACE else "RoadCar", (2.0, 2.0, 0.0))
    with pytest.raises(ValueError, match="centre line of a scene is None; expected one, as"):
        env.reset(options={"scene": scene})


def test_a_hill_is_climbed_and_its_edge_is_left_at_a_cost() -> None:
    env = gymnasium.make(HILL)
    observation, facts = env.reset(seed=3)
    truth = env.unwrapped.simulation.truth
    start = truth.pose_in_space()[2]
    assert (observation[:8] > 0.1).all() and (observation[:8] < 0.6).all()
    total, over = 0.0, False
    while not over:
        # Straight on, until it falls off the border or rolls over.
        _, reward, over, truncated, _ = env.step(np.array([0.2, 0.0], np.float32))
        total += float(reward)
        if not over:
            assert total == pytest.approx(truth.pose_in_space()[2] - start, abs=1e-9)
        assert not truncated
    assert reward == -1.0 and truth.mishap() in ("tipped over", "fell")
    with pytest.raises(ValueError, match="distance sensors; expected at least 8"):
        env.reset(options={"scene": with_robot(Scene.hills(1), "Blizzard")})


def test_a_depth_is_drawn_and_held() -> None:
    env = gymnasium.make(DIVE, noise=0.0)
    observation, _ = env.reset(seed=2)
    inner = env.unwrapped
    wanted, policy = inner.task.depths[0], inner.baseline()
    assert 0.4 <= wanted <= 1.1 and observation[0] < -0.2
    for step in range(400):
        observation, reward, *_ = env.step(policy(observation))
        truth = inner.simulation.truth.pose_in_space()
        depth = inner.scene.water_level - truth[2] - 0.26
        off = max(1.0 - abs(depth - wanted) / 0.1, 0.0)
        assert step > 100 or float(reward) <= off + 1e-9
    assert observation[0] == pytest.approx(depth - wanted, abs=0.01) and abs(depth - wanted) < 0.02 and reward > 0.8
    # Without thrust it comes up.
    for _ in range(200):
        observation, reward, *_ = env.step(np.zeros(4, np.float32))
    assert observation[0] < -0.2 and reward == 0.0
    with pytest.raises(ValueError, match="the scene has no water"):
        env.reset(options={"scene": Scene.walled(2.0, 2.0)})


def with_robot(scene: Scene, name: str) -> Scene:
    scene.add_robot(name)
    return scene


def test_a_lane_is_seen_by_the_camera_only_where_one_is() -> None:
    seen, unseen = envs.LaneKeeping(), envs.LaneKeeping(camera=False)
    first, _ = seen.reset(seed=4)
    second, _ = unseen.reset(seed=4)
    assert np.array_equal(first, second)
    assert seen.image().max() > 200 and seen.image()[200:].std() > 2.0 * unseen.image()[200:].std()


def test_wrong_arguments_are_named() -> None:
    with pytest.raises(ValueError, match="render_mode is 'rgb_array'; expected None or 'svg'"):
        envs.WallFollowing(render_mode="rgb_array")
    with pytest.raises(ValueError, match="period is 0; expected 0.01 to 1 s"):
        envs.GoalReaching(period=0)
    with pytest.raises(ValueError, match="the scene has no goal"):
        envs.GoalReaching().reset(options={"scene": Scene.room(1)})
    with pytest.raises(ValueError, match="num_envs is 0; expected at least 1"):
        gymnasium.make_vec(WALL, num_envs=0)
    vector = gymnasium.make_vec(WALL, num_envs=2)
    with pytest.raises(ValueError, match="seed has 1 numbers; expected 2"):
        vector.reset(seed=[1])
    vector.reset(seed=1)
    with pytest.raises(ValueError, match=r"actions is an array of shape \(2,\); expected shape \(2, 2\)"):
        vector.step(np.zeros(2, np.float32))


def test_facts_of_a_step_are_kept() -> None:
    env = gymnasium.make_vec(WALL, num_envs=2)
    env.reset(seed=np.int64(3))
    action = np.full((2, 2), 0.2, np.float32)
    *_, facts = env.step(action)
    kept = {name: value.copy() for name, value in facts.items()}
    for _ in range(5):
        env.step(action)
    assert all(np.array_equal(value, kept[name]) for name, value in facts.items())


def test_an_episode_has_to_begin() -> None:
    for env in (gymnasium.make(WALL).unwrapped, gymnasium.make_vec(WALL, num_envs=1).unwrapped):
        with pytest.raises(gymnasium.error.ResetNeeded, match="expected reset"):
            env.step(env.action_space.sample())
    with pytest.raises(ValueError, match="max_episode_steps is 0; expected at least 1"):
        envs.RobotVectorEnvironment(envs.WallFollowing, 1, max_episode_steps=0)


def test_seeds_of_numpy_are_seeds() -> None:
    env = gymnasium.make_vec(WALL, num_envs=2)
    first = env.reset(seed=3)[0]
    assert np.array_equal(env.reset(seed=np.int64(3))[0], first)
    assert np.array_equal(env.reset(seed=[np.int64(3), 4])[0], first)
