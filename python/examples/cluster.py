"""A campaign on two local Ray nodes, one of which is lost in the middle: the report is that of one machine."""

import os
import subprocess
import sys

# On small machines Ray's monitor of memory would end workers.
os.environ["RAY_memory_monitor_refresh_ms"] = "0"

import ray
from ray.cluster_utils import Cluster

from roverlab.ray import campaign


def main(worlds: int) -> None:
    command = ["distbug", "--campaign", "--worlds", str(worlds), "--levels", "1"]
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    second = cluster.add_node(num_cpus=1)
    ray.init(address=cluster.address, log_to_driver=False, logging_level="ERROR")

    def progress(done: int, parts: int) -> None:
        print(f"{done} of {parts} parts")
        if done == 2:
            cluster.remove_node(second, allow_graceful=False)
            print("a node is lost")

    report = campaign(command, parts=8, progress=progress)
    program = [sys.executable, "-m", "roverlab"]
    alone = subprocess.run([*program, *command, "--json"], capture_output=True, text=True).stdout
    print(report, "equal to that of one machine:", report == alone)
    ray.shutdown()
    cluster.shutdown()


if __name__ == "__main__":
    main(4 if len(sys.argv) > 1 else 100)
