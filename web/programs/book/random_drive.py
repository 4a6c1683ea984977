"""Straight on until something is near, then a turn by chance."""
import random

from eye import *

SAFE = 300

turns = 0
while turns < 6:
    VWSetSpeed(250, 0)
    while PSDGet(PSD_FRONT) > SAFE and PSDGet(PSD_LEFT) > SAFE / 2 and PSDGet(PSD_RIGHT) > SAFE / 2:
        OSWait(50)
    VWSetSpeed(0, 0)
    VWStraight(-100, 150)
    VWWait()
    angle = random.randint(90, 180) * random.choice([-1, 1])
    LCDPrintf("turn %d\n", angle)
    VWTurn(angle, 90)
    VWWait()
    turns += 1
