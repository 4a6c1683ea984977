"""Finds the coloured objects that a robot's camera sees: hue, threshold, and the mean of each side."""

import sys
from pathlib import Path

import numpy as np

from roverlab import vision
from roverlab.sim import Scene, Simulation


def main(folder: Path) -> None:
    scene = Scene.walled(3.0, 3.0)
    scene.add_robot("S4", (1.0, 1.5, 0.0))
    scene.add_object("soccer", (2.0, 1.7, 0.0))
    scene.add_object("can", (1.8, 1.2, 0.0))
    image = Simulation(scene, seed=1).robot().image(320, 240)

    gray = vision.gray(image)
    smooth = vision.gaussian(gray, 5)
    edges = vision.canny(smooth, 30, 90)
    marked = vision.threshold(vision.sobel(smooth), 60)
    # Pixels with a colour: red, green and blue differ.
    coloured = image.max(axis=2).astype(int) - image.min(axis=2) > 60
    hues = vision.hue(image)[coloured]

    print(f"{(edges > 0).sum()} pixels of edges, {(marked > 0).mean():.1%} with a steep gradient")
    print(f"{coloured.sum()} coloured pixels, hues {np.unique(hues)[:5].tolist()}")
    if coloured.any():
        columns = np.nonzero(coloured)[1]
        print(f"the coloured things are about {columns.mean() - 159.5:+.0f} pixels from the middle")
    file = folder / "edges.pgm"
    file.write_bytes(b"P5 320 240 255\n" + edges.tobytes())
    print(file.name)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path())
