"""A map of the hall on the display, from scans at a few places."""
from math import cos, radians, sin

from eye import *

cells = set()
for place in range(4):
    x, y, phi = VWGetPosition()
    for index, distance in enumerate(LIDARGet()):
        angle = radians(phi + 180 - index)
        if distance < 5000:
            cells.add((round((x + distance * cos(angle)) / 50), round((y + distance * sin(angle)) / 50)))
    VWStraight(500, 250)
    VWWait()
    VWTurn(90, 90)
    VWWait()
for column, row in cells:
    LCDArea(240 + 3 * column, 160 - 3 * row, 242 + 3 * column, 162 - 3 * row, WHITE, 1)
LCDSetPrintf(0, 0, "%d cells\n", len(cells))
