"""Evolution of vectors of real numbers."""

from ._native import CmaEs

__all__ = ["CmaEs"]
