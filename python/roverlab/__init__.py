"""Robots of a textbook in Python: simulation, navigation, mazes and vision on numpy arrays.

Modules
-------
sim
    Worlds and robots, one or thousands, in virtual time.
drive, nav
    Behaviours that drive a robot; planners on maps.
maze
    Mazes, flood fill and shortest routes.
vision
    Kernels on images of uint8.
evolve
    Evolution of vectors of real numbers.
log
    Recordings as arrays and tables.
ray
    Campaigns and evolution on a Ray cluster, with ``pip install roverlab[ray]``.
envs
    Environments for Gymnasium, which ``pip install roverlab[envs]`` brings.

Units are metres, seconds and radians: x ahead, y to the left, angles counter-clockwise. Wrong values raise
``ValueError`` and wrong types ``TypeError``; the message says what was found and what is expected.
"""

from . import drive, evolve, log, maze, nav, sim, vision
from ._native import FileFormatError, NoPathError, RobotError, UnsupportedError, __version__

__all__ = [
    "FileFormatError",
    "NoPathError",
    "RobotError",
    "UnsupportedError",
    "__version__",
    "drive",
    "evolve",
    "log",
    "maze",
    "nav",
    "sim",
    "vision",
]
