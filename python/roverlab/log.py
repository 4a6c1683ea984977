"""Recordings of runs as arrays and tables.

`Recording` reads the files that ``--record`` of the program's commands writes. Bags of ROS 2 become recordings by
``roverlab replay import --ros2 BAG.mcap --out RUN.mcap``. A table is a dict of columns of equal length.
"""

from __future__ import annotations

import csv as _csv
import os as _os
from collections.abc import Mapping as _Mapping
from collections.abc import Sequence as _Sequence
from importlib.util import find_spec as _find_spec
from typing import Any as _Any

import numpy as _np

from ._native import Recording

__all__ = ["Recording", "save_csv", "to_rerun"]


def save_csv(table: _Mapping[str, _Any], path: str | _os.PathLike[str]) -> None:
    """Writes a table as a file of comma-separated values.

    Parameters
    ----------
    table : dict
        Columns of equal length, such as `Recording.odometry` returns. One of two dimensions becomes a column for each
        of its own: ``ranges_0`` and on.
    path : str or os.PathLike
        The file.

    Raises
    ------
    ValueError
        If columns differ in length, or have more than two dimensions.
    """
    columns: dict[str, _Sequence[_Any]] = {}
    for name, column in table.items():
        values = _np.asarray(column) if isinstance(column, _np.ndarray) else None
        if values is not None and values.ndim == 2:
            columns |= {f"{name}_{number}": values[:, number].tolist() for number in range(values.shape[1])}
        elif values is not None and values.ndim > 2 or any(isinstance(cell, _np.ndarray) for cell in column):
            raise ValueError(f"{name} is a column of arrays; expected numbers or texts")
        else:
            columns[name] = column if values is None else values.tolist()
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"the columns have the lengths {lengths}; expected equal ones")
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = _csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))


def to_rerun(recording: Recording, path: str | _os.PathLike[str] | None = None) -> None:
    """Shows a recording in the viewer Rerun, or writes it to a file for it: world, scans, paths and images.

    Parameters
    ----------
    recording : Recording
        The recording.
    path : str or os.PathLike, optional
        A file ``.rrd`` to write; without it, a viewer is opened.

    Raises
    ------
    ModuleNotFoundError
        If Rerun is not installed: ``pip install roverlab[rerun]``.
    """
    if _find_spec("rerun") is None:
        raise ModuleNotFoundError("to_rerun needs rerun-sdk; expected: pip install roverlab[rerun]")
    from ._rerun import show

    show(recording, path)
