"""The connection to a cluster."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any


def connected() -> Any:
    """The module ray, connected to a cluster."""
    if find_spec("ray") is None:
        raise ModuleNotFoundError("roverlab.ray needs ray; expected: pip install roverlab[ray]")
    # An extra, which may not be there when types are checked.
    ray = import_module("ray")
    if not ray.is_initialized():
        ray.init(log_to_driver=False, logging_level="ERROR")
    return ray
