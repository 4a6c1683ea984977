"""Mazes: files of all common formats, random mazes, flood fill, shortest routes."""

from ._native import Maze, Route

__all__ = ["Maze", "Route"]
