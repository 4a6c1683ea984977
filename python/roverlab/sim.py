"""Worlds and robots in virtual time.

A `Scene` is a world with robots, from a file, a text, a generator, or built wall by wall. A `Simulation` runs it:
its robots are commanded and read one by one. A `Batch` steps many robots, in one world or in many, in one call and
without a copy in Python. The same scene, seed and calls give the same run, to the bit.
"""

from ._native import Batch, Robot, RobotSpec, Scene, Simulation, Truth

__all__ = ["Batch", "Robot", "RobotSpec", "Scene", "Simulation", "Truth"]
