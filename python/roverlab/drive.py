"""Behaviours that drive a robot of a simulation."""

from ._native import Ascent, Dive, Follower, LaneKeeper, Racer, WallFollower

__all__ = ["Ascent", "Dive", "Follower", "LaneKeeper", "Racer", "WallFollower"]
