"""A square by four straight lines and turns."""
from eye import *

for side in range(4):
    VWStraight(600, 300)
    VWWait()
    VWTurn(90, 90)
    VWWait()
    x, y, phi = VWGetPosition()
    LCDPrintf("corner %d: %d %d %d\n", side + 1, x, y, phi)
