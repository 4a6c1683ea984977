"""Lanes up and down a lawn of 2 m by 1.2 m."""
from eye import *

LENGTH, WIDTH, LANES = 1200, 200, 6

VWSetPosition(0, 0, 0)
for lane in range(LANES):
    VWStraight(LENGTH, 400)
    VWWait()
    side = 90 if lane % 2 == 0 else -90
    if lane < LANES - 1:
        VWTurn(side, 120)
        VWWait()
        VWStraight(WIDTH, 200)
        VWWait()
        VWTurn(side, 120)
        VWWait()
    LCDPrintf("lane %d of %d\n", lane + 1, LANES)
