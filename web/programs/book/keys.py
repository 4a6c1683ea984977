"""Driven by the soft keys."""
from eye import *

LCDMenu("AHEAD", "LEFT", "RIGHT", "END")
while True:
    key = KEYGet()
    if key == KEY1:
        VWStraight(300, 200)
    elif key == KEY2:
        VWTurn(45, 90)
    elif key == KEY3:
        VWTurn(-45, 90)
    else:
        break
    VWWait()
    LCDPrintf("key %d: now at %d %d %d\n", key, *VWGetPosition())
