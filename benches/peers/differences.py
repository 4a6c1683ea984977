#!/usr/bin/env python3
"""Runs `roverlab edges` and OpenCV on all images of a folder and prints where they differ, kernel by kernel.

Definitions are OpenCV's. For Canny and Hough, the share of pixels and of lines that agree.
"""

import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import cv2
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]


def saturated(image):
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


def references(rgb):
    """What OpenCV makes of an image, by the name of our kernel."""
    gray = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    dx, dy = (cv2.Sobel(gray, cv2.CV_32F, *order) for order in ((1, 0), (0, 1)))
    hsv = cv2.cvtColor(rgb, cv2.COLOR_RGB2HSV)
    hue = hsv[..., 0].astype(int)
    near = np.minimum((hue - 0) % 180, (0 - hue) % 180) < 10
    return {
        "gray": gray,
        "laplace": cv2.convertScaleAbs(cv2.Laplacian(gray, cv2.CV_16S, ksize=1)),
        "laplace_saturated": cv2.Laplacian(gray, cv2.CV_8U, ksize=1),
        "sobel_l1": saturated(np.abs(dx) + np.abs(dy)),
        "sobel_l2": saturated(cv2.magnitude(dx, dy)),
        "gaussian3": cv2.GaussianBlur(gray, (3, 3), 0),
        "gaussian5": cv2.GaussianBlur(gray, (5, 5), 0),
        "gaussian7": cv2.GaussianBlur(gray, (7, 7), 0),
        "threshold": cv2.threshold(gray, 128, 255, cv2.THRESH_BINARY)[1],
        "hue": hsv[..., 0],
        "saturation": hsv[..., 1],
        "intensity": hsv[..., 2],
        "hsi_to_rgb": cv2.cvtColor(rgb, cv2.COLOR_HSV2RGB),
        "hue_match": np.where(near, 255, 0).astype(np.uint8),
        "canny": cv2.Canny(gray, 50, 100),
    }


def edges(program, *options):
    command = [program, "edges", "--json", "--definition", "opencv", "--repeat", "1", *map(str, options)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def hough_agreement(program, file, rgb):
    """The shares of our lines that OpenCV has too, and of OpenCV's that we have, and the number of these."""
    gray = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    votes = max(40, min(gray.shape) // 4)
    found = cv2.HoughLines(cv2.Canny(gray, 50, 100), 1, math.pi / 180, votes)
    theirs = set() if found is None else {(round(float(r)), round(math.degrees(float(t)))) for r, t in found[:, 0]}
    report = edges(program, "--input", file, "--kernel", "hough", "--threshold", votes)
    mine = {(round(line["rho"]), round(line["theta_deg"])) for line in report["lines"]}
    share = lambda a, b: len(a & b) / len(a) if a else 1.0
    return share(mine, theirs), share(theirs, mine), len(theirs)


def equal_segments(program, file, rgb):
    """Whether both find the same segments in the same order, and their number."""
    gray = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    found = cv2.HoughLinesP(cv2.Canny(gray, 50, 100), 1, math.pi / 180, 50, minLineLength=30, maxLineGap=5)
    theirs = [] if found is None else found.reshape(-1, 4).tolist()
    return edges(program, "--input", file, "--kernel", "hough_probabilistic")["lines"] == theirs, len(theirs)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    options = parser.parse_args()
    subprocess.run(["cargo", "build", "--quiet", "--release", "-p", "roverlab-cli"], cwd=ROOT, check=True)
    target = json.loads(
        subprocess.run(
            ["cargo", "metadata", "--format-version", "1", "--no-deps"], cwd=ROOT, check=True, capture_output=True
        ).stdout
    )["target_directory"]
    program = pathlib.Path(target) / "release" / "roverlab"
    worst, unequal, agreement, lines, segments = {}, {}, {}, [], []
    images = 0
    with tempfile.TemporaryDirectory() as name:
        output = pathlib.Path(name) / "out.png"
        for file in sorted(options.folder.rglob("*")):
            if file.suffix.lower() not in (".png", ".ppm", ".pgm", ".bmp"):
                continue
            bgr = cv2.imread(str(file), cv2.IMREAD_COLOR)
            alpha = cv2.imread(str(file), cv2.IMREAD_UNCHANGED)
            if bgr is None or (alpha.ndim == 3 and alpha.shape[2] == 4):
                continue
            images += 1
            rgb = cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB)
            for kernel, expected in references(rgb).items():
                edges(program, "--input", file, "--kernel", kernel, "--output", output)
                found = cv2.imread(str(output), cv2.IMREAD_COLOR if expected.ndim == 3 else cv2.IMREAD_GRAYSCALE)
                if expected.ndim == 3:
                    found = cv2.cvtColor(found, cv2.COLOR_BGR2RGB)
                difference = np.abs(found.astype(int) - expected.astype(int))
                if kernel == "canny":
                    agreement.setdefault(kernel, []).append(float((difference == 0).mean()))
                worst[kernel] = max(worst.get(kernel, 0), int(difference.max()))
                unequal[kernel] = unequal.get(kernel, 0) + int((difference > 0).sum())
            lines.append(hough_agreement(program, file, rgb))
            segments.append(equal_segments(program, file, rgb))
    print(f"{images} images\n\n| kernel | largest difference | pixels that differ |\n|---|---|---|")
    for kernel, level in worst.items():
        print(f"| {kernel} | {level} | {unequal[kernel]} |")
    for kernel, shares in agreement.items():
        print(f"\n{kernel}: at least {100 * min(shares):.3f} % of an image's pixels agree")
    mine, theirs, count = (sum(column) for column in zip(*lines))
    if lines:
        print(f"hough: {100 * mine / len(lines):.2f} % of our lines are OpenCV's, {100 * theirs / len(lines):.2f} % of OpenCV's are ours ({count} lines)")
        equal = sum(same for same, _ in segments)
        count = sum(number for _, number in segments)
        print(f"hough_probabilistic: equal in {equal} of {len(segments)} images ({count} segments)")
    return 0


if __name__ == "__main__":
    sys.exit(main())
