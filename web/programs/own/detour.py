"""To a goal behind a wall: towards it where the way is free, else along the wall."""
# robios --world=wall.wld --start=500,1500,0
from math import atan2, degrees, hypot

from eye import *

GOAL = (2500, 0)


def bearing(x, y, phi):
    return (degrees(atan2(GOAL[1] - y, GOAL[0] - x)) - phi + 180) % 360 - 180


for step in range(2000):
    x, y, phi = VWGetPosition()
    scan = LIDARGet()
    if hypot(GOAL[0] - x, GOAL[1] - y) < 80:
        break
    aim = bearing(x, y, phi)
    # The free direction nearest to that of the goal; index 180 is straight ahead, and higher ones are to the right.
    ways = [a for a in range(-120, 121, 10) if min(scan[180 - a - 35 : 180 - a + 36]) > 350]
    way = min(ways, key=lambda a: abs(a - aim)) if ways else 90
    VWSetSpeed(200 if abs(way) < 40 else 30, int(max(-90, min(90, 2 * way))))
    OSWait(30)
VWSetSpeed(0, 0)
LCDPrintf("%d %d after %d steps\n", x, y, step)
