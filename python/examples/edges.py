"""A vision pipeline: a camera's image, smoothed, its edges, and where the can is. Usage: edges.py [FOLDER]"""

import sys
from pathlib import Path

import numpy as np

from roverlab import vision
from roverlab.sim import Scene, Simulation

scene = Scene.walled(2.0, 2.0)
scene.add_object("can", (1.2, 1.05, 0.0))
scene.add_robot("S4", (0.8, 1.0, 0.0))
image = Simulation(scene, seed=1).robot().image(320, 240)

# Every kernel can write into an array that is there already.
gray = vision.gray(image, weights="rec601")
smooth, edges = np.empty_like(gray), np.empty_like(gray)
vision.gaussian(gray, 5, out=smooth)
vision.canny(smooth, 50, 100, out=edges)
print(f"{np.count_nonzero(edges)} of {edges.size} pixels are edges")

# The can is red: hue 42 on RoBIOS's scale.
hue = vision.hue(image)
can = abs(hue.astype(int) - 42) < 10
columns = np.flatnonzero(can.sum(axis=0) > 5)
print(f"the can is in columns {columns[0]} to {columns[-1]} of {image.shape[1]}")
assert columns[-1] < 160, "it stands to the left"

# A part of an image is an image as well, without a copy.
part = gray[:, columns[0] : columns[-1] + 1]
print(f"mean gradient: {vision.sobel(part).mean():.1f} at the can, {vision.sobel(gray).mean():.1f} in all")

folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path()
header = f"P5 {edges.shape[1]} {edges.shape[0]} 255\n".encode()
(folder / "edges.pgm").write_bytes(header + edges.tobytes())
