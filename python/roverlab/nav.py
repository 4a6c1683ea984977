"""Planning on maps, and navigation among unknown obstacles.

Maps are arrays of shape (rows, columns), and cells are given as (row, column), as an array is indexed.
"""

from ._native import Bug, DStarLite, NoPathError, Path, Planner, distance_field, inflate

__all__ = ["Bug", "DStarLite", "NoPathError", "Path", "Planner", "distance_field", "inflate"]
