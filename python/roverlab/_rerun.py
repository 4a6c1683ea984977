"""Recordings for the viewer Rerun."""

from __future__ import annotations

import math
import os
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._native import Recording


def show(recording: Recording, path: str | os.PathLike[str] | None) -> None:
    """Writes a recording to a file, or opens a viewer."""
    # An extra, which may not be there when types are checked.
    rr: Any = import_module("rerun")
    stream = rr.RecordingStream(f"roverlab {recording.program}")
    if path is None:
        stream.spawn()
    else:
        stream.save(os.fspath(path))
    scene = recording.scene()
    if scene is not None and len(scene.walls):
        stream.log("world/walls", rr.LineStrips2D(scene.walls.reshape(-1, 2, 2)), static=True)
    for robot in range(recording.robots):
        _show_robot(rr, stream, recording, robot)
    stream.flush()


def _show_robot(rr: Any, stream: Any, recording: Recording, robot: int) -> None:
    name = f"world/robot{robot + 1}"
    start = recording.start(robot) or (0.0, 0.0, 0.0)
    odometry, scans = recording.odometry(robot), recording.scans(robot)
    times, own = odometry["time"], np.stack([odometry["x"], odometry["y"], odometry["heading"]], axis=1)
    poses = _composed(start, own)
    if len(poses):
        stream.log(f"{name}/odometry", rr.LineStrips2D([poses[:, :2]]), static=True)
    for time, pose in zip(times, poses, strict=True):
        stream.set_time("time", duration=time)
        stream.log(f"{name}/pose", rr.Points2D([pose[:2]], radii=0.05))
    truth = recording.truth(robot)
    if len(truth["time"]):
        stream.log(f"{name}/truth", rr.LineStrips2D([np.stack([truth["x"], truth["y"]], axis=1)]), static=True)
    # A scan is shown at the last pose before it.
    before = np.searchsorted(times, scans["time"], side="right") - 1
    for number, (time, last) in enumerate(zip(scans["time"], before, strict=True)):
        stream.set_time("time", duration=time)
        pose = poses[last] if last >= 0 else np.array(start)
        stream.log(f"{name}/scan", rr.Points2D(_points(scans, number, pose)))
    for display, topic in ((False, "camera"), (True, "display")):
        images = recording.images(robot, display)
        for time, image in zip(images["time"], images["image"], strict=True):
            stream.set_time("time", duration=time)
            stream.log(f"robot{robot + 1}/{topic}", rr.Image(image))


def _composed(start: tuple[float, float, float], own: NDArray[np.float64]) -> NDArray[np.float64]:
    """Poses in the world of poses relative to a start."""
    x, y, heading = start
    cos, sin = math.cos(heading), math.sin(heading)
    columns = (x + cos * own[:, 0] - sin * own[:, 1], y + sin * own[:, 0] + cos * own[:, 1], heading + own[:, 2])
    return np.stack(columns, axis=1)


def _points(scans: Any, number: int, pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where the beams of a scan ended."""
    ranges = scans["ranges"][number]
    angles = scans["angle_min"][number] + scans["angle_increment"][number] * np.arange(len(ranges)) + pose[2]
    hit = np.isfinite(ranges)
    x, y = pose[0] + ranges[hit] * np.cos(angles[hit]), pose[1] + ranges[hit] * np.sin(angles[hit])
    return np.stack([x, y], axis=1)
