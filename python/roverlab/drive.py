"""Behaviours that drive a robot of a simulation."""

from ._native import WallFollower

__all__ = ["WallFollower"]
