"""A vehicle that shies away from walls: each sensor slows the motor of the other side."""
from eye import *


def fear(distance):
    return max(0.0, min(1.0, (600 - distance) / 500))


end = OSGetCount() + 20_000
while OSGetCount() < end:
    front, left, right = PSDGet(PSD_FRONT), PSDGet(PSD_LEFT), PSDGet(PSD_RIGHT)
    away = fear(right) - fear(left) + 2 * fear(front)
    VWSetSpeed(int(250 * (1 - fear(front))), int(90 * max(-1.0, min(1.0, away))))
VWSetSpeed(0, 0)
LCDPrintf("at %d %d after %d ms\n", *VWGetPosition()[:2], OSGetCount())
