"""A lying eight, by speeds that are a function of time."""
from math import cos, pi

from eye import *

PERIOD, SPEED = 16.0, 200

start = OSGetCount()
while True:
    time = (OSGetCount() - start) / 1000
    if time >= PERIOD:
        break
    VWSetSpeed(SPEED, int(80 * cos(2 * pi * time / PERIOD)))
    OSWait(40)
VWSetSpeed(0, 0)
LCDPrintf("%d %d %d\n", *VWGetPosition())
