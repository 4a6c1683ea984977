"""Kernels on images: arrays of uint8, gray of shape (height, width) or colour of shape (height, width, 3).

An array whose rows hold their pixels side by side is used where it is, also a part of a larger image; any other is
copied first. With ``out``, the result is written there and no image is allocated. ``out`` must lie in memory apart
from the image: not on it, and not between its rows.
"""

from ._native import absolute_difference, canny, gaussian, gray, hue, laplace, sobel, threshold

__all__ = ["absolute_difference", "canny", "gaussian", "gray", "hue", "laplace", "sobel", "threshold"]
