"""Behaviours that drive a robot of a simulation."""

from ._native import Follower, LaneKeeper, Racer, WallFollower

__all__ = ["Follower", "LaneKeeper", "Racer", "WallFollower"]
