"""Kernels on numpy images."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from roverlab import vision

Image = NDArray[np.uint8]
KERNELS: dict[str, Callable[..., Image]] = {
    "sobel": vision.sobel,
    "laplace": vision.laplace,
    "canny": vision.canny,
    "gaussian": vision.gaussian,
    "threshold": lambda image, **more: vision.threshold(image, 99, **more),
    "difference": lambda image, **more: vision.absolute_difference(image, image.copy()[::-1].copy(), **more),
}
COLOURS: dict[str, Callable[..., Image]] = {"gray": vision.gray, "hue": vision.hue}


def picture(seed: int, height: int = 9, width: int = 13, channels: int | None = None) -> Image:
    shape = (height, width) if channels is None else (height, width, channels)
    return np.random.default_rng(seed).integers(0, 256, shape, np.uint8)


def shifted(image: Image, down: int, right: int) -> NDArray[np.int64]:
    padded = np.pad(image.astype(np.int64), 1, mode="reflect")
    height, width = image.shape
    return padded[1 + down : 1 + down + height, 1 + right : 1 + right + width]


@given(st.integers(0, 2**32), st.integers(2, 40), st.integers(2, 40))
def test_sobel_is_what_its_definition_says(seed: int, height: int, width: int) -> None:
    image = picture(seed, height, width)
    s = {(y, x): shifted(image, y, x) for y in (-1, 0, 1) for x in (-1, 0, 1)}
    dx = (s[-1, 1] + 2 * s[0, 1] + s[1, 1]) - (s[-1, -1] + 2 * s[0, -1] + s[1, -1])
    dy = (s[1, -1] + 2 * s[1, 0] + s[1, 1]) - (s[-1, -1] + 2 * s[-1, 0] + s[-1, 1])
    sums = np.minimum(abs(dx) + abs(dy), 255)
    assert np.array_equal(vision.sobel(image, border="mirror"), sums)
    roots = np.minimum(np.rint(np.sqrt(dx * dx + dy * dy)), 255)
    assert np.array_equal(vision.sobel(image, norm="l2", border="mirror"), roots)
    laplace = np.minimum(abs(4 * s[0, 0] - s[-1, 0] - s[1, 0] - s[0, -1] - s[0, 1]), 255)
    assert np.array_equal(vision.laplace(image, border="mirror"), laplace)
    zero = vision.sobel(image)
    assert np.array_equal(zero[1:-1, 1:-1], sums[1:-1, 1:-1]) and not zero[0].any() and not zero[:, -1].any()


def test_single_pixels_and_small_kernels() -> None:
    image = picture(1)
    assert np.array_equal(vision.threshold(image, 99), np.where(image > 99, 255, 0))
    other = picture(2)
    difference = abs(image.astype(int) - other.astype(int))
    assert np.array_equal(vision.absolute_difference(image, other), difference)
    colours = picture(3, channels=3).astype(int)
    gray = (colours[..., 0] + colours[..., 2]) // 4 + colours[..., 1] // 2
    assert np.array_equal(vision.gray(colours.astype(np.uint8)), gray)
    assert vision.hue(np.array([[[200, 10, 10]]], np.uint8)) == 42
    assert vision.hue(np.array([[[200, 10, 10]]], np.uint8), scale="opencv") == 0
    flat = np.full((8, 8), 77, np.uint8)
    for size in (3, 5, 7):
        assert np.array_equal(vision.gaussian(flat, size), flat)
        assert np.array_equal(vision.gaussian(flat, size, 0.8), flat)
    step = np.zeros((9, 9), np.uint8)
    step[:, 5:] = 200
    assert (vision.canny(step) == 255).sum(axis=1).tolist() == [1] * 9


def arrangements(image: Image) -> list[Image]:
    """The same image in other strides."""
    height, width = image.shape[:2]
    larger = np.zeros((height + 4, width + 5, *image.shape[2:]), np.uint8)
    larger[2:-2, 3:-2] = image
    sparse = np.repeat(np.repeat(image, 2, axis=0), 3, axis=1)
    return [
        np.asfortranarray(image),
        larger[2:-2, 3:-2],
        sparse[::2, ::3],
        sparse[::2][:, ::3],
        image[::-1].copy()[::-1],
        image[:, ::-1].copy()[:, ::-1],
    ]


@pytest.mark.parametrize("name", [*KERNELS, *COLOURS])
def test_strides_do_not_matter(name: str) -> None:
    kernel = {**KERNELS, **COLOURS}[name]
    image = picture(4, channels=3 if name in COLOURS else None)
    expected = kernel(image)
    assert expected.dtype == np.uint8 and expected.shape == image.shape[:2] and expected.flags.c_contiguous
    for other in arrangements(image):
        assert np.array_equal(kernel(other), expected)
        for out in arrangements(np.zeros_like(expected)):
            assert kernel(image, out=out) is out
            assert np.array_equal(out, expected)


@pytest.mark.parametrize("name", [*KERNELS, *COLOURS])
def test_what_is_around_a_part_is_left_alone(name: str) -> None:
    kernel = {**KERNELS, **COLOURS}[name]
    image = picture(5, 40, 60, 3 if name in COLOURS else None)
    around = np.full((50, 70), 17, np.uint8)
    kernel(image, out=around[3:43, 4:64])
    assert (around[:3] == 17).all() and (around[43:] == 17).all()
    assert (around[:, :4] == 17).all() and (around[:, 64:] == 17).all()


def test_parts_of_one_image_may_be_read_and_written() -> None:
    image = picture(6, 20, 40)
    expected = vision.sobel(image[:10])
    vision.sobel(image[:10], out=image[10:])
    assert np.array_equal(image[10:], expected)
    with pytest.raises(ValueError, match="out is in use, or in memory that another argument uses"):
        vision.sobel(image[:, :20], out=image[:, 20:])


def test_large_images_are_used_where_they_are() -> None:
    """A copy of 64 MB would take far longer than a part of 1 kB of it."""
    image = np.zeros((8192, 8192), np.uint8)
    part, out = image[4000:4032, 4000:4032], np.empty((32, 32), np.uint8)
    part[:, 16:] = 200
    vision.sobel(part, out=out)
    assert out.max() == 255


def test_wrong_images_are_named() -> None:
    image: Any = picture(7)
    with pytest.raises(TypeError, match="image is an array of float64; expected an array of uint8"):
        vision.sobel(image.astype(np.float64))
    with pytest.raises(TypeError, match="image is <class 'list'>; expected an ndarray of uint8"):
        vision.sobel([[1]])  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"shape of image is \(9, 13, 1\); expected shape \(height, width\)"):
        vision.sobel(image[..., None])
    with pytest.raises(ValueError, match=r"shape of image is \(9, 13\); expected shape \(height, width, 3\)"):
        vision.gray(image)
    with pytest.raises(ValueError, match="size of out is 13 x 9; expected 9 x 13, as the image"):
        vision.sobel(image, out=np.zeros((13, 9), np.uint8))
    with pytest.raises(TypeError, match="out is an array of int8"):
        vision.sobel(image, out=image.view(np.int8))
    with pytest.raises(ValueError, match="out is in use, or in memory that another argument uses"):
        vision.sobel(image, out=image)
    with pytest.raises(ValueError, match="out is in use, or in memory that another argument uses"):
        vision.sobel(image[:-1], out=image[1:])
    fixed = np.zeros_like(image)
    fixed.flags.writeable = False
    with pytest.raises(ValueError, match="out is read-only; expected a writable array"):
        vision.sobel(image, out=fixed)
    with pytest.raises(ValueError, match="the image is 0 x 0 pixels; expected at least one pixel"):
        vision.sobel(np.zeros((0, 0), np.uint8))
    with pytest.raises(ValueError, match="the second image is 13 x 8; expected 13 x 9"):
        vision.absolute_difference(image, image[1:])
    with pytest.raises(ValueError, match="low threshold is 9; expected at most the high threshold"):
        vision.canny(image, 9, 8)
    with pytest.raises(ValueError, match="Gaussian size is 4; expected 3, 5 or 7"):
        vision.gaussian(image, 4)  # type: ignore[arg-type]
    colours: Any = picture(1, channels=3)
    for kernel, argument, option in (
        (vision.sobel, image, {"norm": "l3"}),
        (vision.sobel, image, {"border": "red"}),
        (vision.gray, colours, {"weights": "x"}),
        (vision.hue, colours, {"scale": "x"}),
    ):
        unchecked: Any = kernel
        with pytest.raises(ValueError, match=f'{next(iter(option))} is ".*"; expected .* or .*'):
            unchecked(argument, **option)


@pytest.mark.parametrize("size", [(1, 1), (1, 9), (9, 1), (2, 2), (300, 1000)])
def test_sizes_small_and_large(size: tuple[int, int]) -> None:
    for kernel in KERNELS.values():
        assert kernel(picture(8, *size)).shape == size
    assert vision.sobel(np.broadcast_to(np.uint8(3), size)).shape == size
