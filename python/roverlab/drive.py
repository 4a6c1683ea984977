"""Behaviours that drive a robot of a simulation."""

from ._native import Follower, WallFollower

__all__ = ["Follower", "WallFollower"]
