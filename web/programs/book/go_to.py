"""To a point by steering at it all the time."""
from math import atan2, degrees, hypot

from eye import *

GOAL = (1200, 900)

while True:
    x, y, phi = VWGetPosition()
    dx, dy = GOAL[0] - x, GOAL[1] - y
    if hypot(dx, dy) < 50:
        break
    turn = (degrees(atan2(dy, dx)) - phi + 180) % 360 - 180
    VWSetSpeed(200 if abs(turn) < 45 else 0, int(max(-80, min(80, 2 * turn))))
    OSWait(50)
VWSetSpeed(0, 0)
LCDPrintf("there: %d %d\n", *VWGetPosition()[:2])
