"""A lidar scan as a drawing on the display."""
from math import cos, radians, sin

from eye import *

LCDMenu("SCAN", "", "", "END")
scan = LIDARGet()
LCDCircle(240, 160, 4, RED, 1)
for degree, distance in enumerate(scan):
    angle = radians(degree - 180)
    x, y = 240 + int(distance * sin(angle) / 20), 160 - int(distance * cos(angle) / 20)
    LCDLine(240, 160, x, y, GREEN)
nearest = min(scan)
LCDSetPrintf(0, 0, "nearest %d mm\n", nearest)
VWTurn(list(scan).index(nearest) - 180, 60)
VWWait()
KEYWait(KEY4)
