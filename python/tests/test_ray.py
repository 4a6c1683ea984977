"""Campaigns and evolution on a cluster of two local nodes."""

import json
import os
import subprocess
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

pytest.importorskip("ray")
# On small machines it would end workers.
os.environ["RAY_memory_monitor_refresh_ms"] = "0"
os.environ["RAY_DISABLE_IMPORT_WARNING"] = "1"

from roverlab import ray as rover_ray  # noqa: E402
from roverlab._programs import find  # noqa: E402
from roverlab.evolve import CmaEs, OneByOne  # noqa: E402
from roverlab.ray._worker import part  # noqa: E402

pytestmark = pytest.mark.filterwarnings("ignore")

CAMPAIGN = ["distbug", "--campaign", "--worlds", "4", "--levels", "0,1", "--seed", "7"]
EVOLUTION = ["starman", "--population", "60", "--generations", "8", "--seed", "3"]


@pytest.fixture
def cluster() -> Iterator[Any]:
    """Two nodes; the second is the last of `nodes`."""
    import ray
    from ray.cluster_utils import Cluster

    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 2})
    cluster.second = cluster.add_node(num_cpus=2)
    ray.init(address=cluster.address, log_to_driver=False, logging_level="ERROR")
    yield cluster
    ray.shutdown()
    cluster.shutdown()


def local(*arguments: str) -> str:
    """The report of the program alone."""
    run = subprocess.run([find("roverlab"), *arguments, "--json"], capture_output=True, text=True)
    assert run.stdout, run.stderr
    return run.stdout


def test_a_campaign_is_that_of_one_machine_and_goes_on(cluster: Any, tmp_path: Path) -> None:
    expected, seen = local(*CAMPAIGN), []
    report = rover_ray.campaign(CAMPAIGN, parts=6, folder=tmp_path, progress=lambda *done: seen.append(done))
    assert report == expected and json.loads(report)["worlds"] == 4
    assert seen == [(done, 6) for done in range(1, 7)] and len(list(tmp_path.iterdir())) == 6
    for number in (2, 5):
        (tmp_path / f"part-{number}-of-6.jsonl").unlink()
    seen.clear()
    assert rover_ray.campaign(CAMPAIGN, parts=6, folder=tmp_path, progress=lambda *done: seen.append(done)) == expected
    assert seen == [(5, 6), (6, 6)]


def test_a_folder_of_another_campaign_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "part-2-of-3.jsonl"
    file.write_bytes(part(CAMPAIGN, 2, 3)[0])
    other = [*CAMPAIGN[:-1], "8"]
    with pytest.raises(ValueError, match=f"folder is {tmp_path}, whose {file.name} is .*--seed=7`; .*--seed=8`"):
        rover_ray.campaign(other, parts=3, folder=tmp_path)
    file.write_bytes(b"")
    with pytest.raises(ValueError, match="is no part of a campaign; expected `distbug"):
        rover_ray.campaign(CAMPAIGN, parts=3, folder=tmp_path)
    assert list(tmp_path.iterdir()) == [file]


def test_wrong_options_are_found_before_a_part_runs(tmp_path: Path) -> None:
    for wrong in (["--csv", "table.csv"], ["--save"]):
        with pytest.raises(RuntimeError, match=f"options: .*{wrong[0]}"):
            rover_ray.campaign(CAMPAIGN, parts=2, folder=tmp_path, options=wrong)
    assert not list(tmp_path.iterdir())


def test_a_campaign_survives_a_node(cluster: Any) -> None:
    def kill(done: int, parts: int) -> None:
        if done == 1:
            cluster.remove_node(cluster.second, allow_graceful=False)

    assert rover_ray.campaign(CAMPAIGN, parts=8, progress=kill) == local(*CAMPAIGN)


def test_an_evolution_is_that_of_one_machine(cluster: Any) -> None:
    assert rover_ray.evolve(EVOLUTION) == local(*EVOLUTION, "--processes", "1")


def test_an_evolution_survives_a_node(cluster: Any) -> None:
    def kill() -> None:
        time.sleep(6.0)
        cluster.remove_node(cluster.second, allow_graceful=False)

    longer = ["starman", "--population", "60", "--generations", "25", "--seed", "3"]
    killer = threading.Thread(target=kill)
    killer.start()
    report = rover_ray.evolve(longer)
    killer.join()
    assert report == local(*longer, "--processes", "1")


def test_fitness_in_python_is_that_of_one_machine_although_a_node_is_lost(cluster: Any) -> None:
    def noisy(genome: NDArray[np.float64], seed: int, generation: int, index: int) -> float:
        # A function of everything that it is given, which takes some milliseconds.
        end = time.perf_counter() + 0.004
        while time.perf_counter() < end:
            pass
        genome -= 1.0
        return float(np.random.default_rng([seed, generation, index]).normal() - 10.0 * genome @ genome)

    here, there = (CmaEs(np.zeros(4), 0.5, 40, seed=3) for _ in range(2))
    one, many = OneByOne(noisy, seed=7), rover_ray.OneByOne(noisy, seed=7)
    for generation in range(12):
        if generation == 6:
            cluster.remove_node(cluster.second, allow_graceful=False)
        here.step(one)
        there.step(many)
    assert here.history.tobytes() == there.history.tobytes() and here.mean.tobytes() == there.mean.tobytes()
    assert here.history[-1, 1] > here.history[0, 1]


def test_an_exception_of_fitness_in_python_is_raised(cluster: Any) -> None:
    def wrong(genome: NDArray[np.float64], seed: int, generation: int, index: int) -> float:
        raise ZeroDivisionError(f"individual {index}")

    search, fitness = CmaEs(np.zeros(4), 0.5, 40), rover_ray.OneByOne(wrong)
    with pytest.raises(ZeroDivisionError, match="individual [0-9]"):
        search.step(fitness)
    assert len(search.history) == 0 and fitness.generation == 0


def test_wrong_campaigns_are_named(cluster: Any) -> None:
    with pytest.raises(ValueError, match="parts is 0; expected 1 to 100000"):
        rover_ray.campaign(CAMPAIGN, parts=0)
    with pytest.raises(RuntimeError, match="--wrlds"):
        rover_ray.campaign(["distbug", "--campaign", "--wrlds", "3"], parts=1)
    with pytest.raises(RuntimeError, match="--populaton"):
        rover_ray.evolve(["starman", "--populaton", "3"])
