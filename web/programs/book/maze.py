"""Through a maze with the left hand at the wall."""
# robios --world=maze.maz
from eye import *

CELL = 360
FREE = 250


def turn(angle):
    VWTurn(angle, 120)
    VWWait()


def ahead():
    VWStraight(CELL, 300)
    VWWait()


for step in range(24):
    if PSDGet(PSD_LEFT) > FREE:
        turn(90)
    elif PSDGet(PSD_FRONT) > FREE:
        pass
    elif PSDGet(PSD_RIGHT) > FREE:
        turn(-90)
    else:
        turn(180)
    ahead()
    x, y, _ = VWGetPosition()
    LCDPrintf("%d:%d ", round(x / CELL), round(y / CELL))
