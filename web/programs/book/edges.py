"""Edges in what the camera sees, and how many there are while the robot turns."""
from eye import *

CAMInit(QQVGA)
LCDImageSize(QQVGA)
for view in range(6):
    gray = CAMGetGray()
    edges = IPSobel(gray)
    LCDImageStart(0, 0, QQVGA_X, QQVGA_Y)
    LCDImageGray(edges)
    LCDSetPrintf(12, 0, "view %d: %d strong edges  ", view + 1, sum(value > 100 for value in edges))
    VWTurn(60, 60)
    VWWait()
CAMRelease()
