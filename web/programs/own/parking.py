"""Measures a gap beside the lane, and parks in it if it is long enough."""
# robios --world=gap.wld --start=500,1100,0
from eye import *

NEEDED = 400

VWSetSpeed(150, 0)
while PSDGet(PSD_RIGHT) < 500:
    OSWait(20)
begin = VWGetPosition()[0]
while PSDGet(PSD_RIGHT) > 500:
    OSWait(20)
end = VWGetPosition()[0]
VWSetSpeed(0, 0)
LCDPrintf("gap of %d mm\n", end - begin)
if end - begin > NEEDED:
    VWStraight(-(end - begin) // 2, 150)
    VWWait()
    VWTurn(-90, 60)
    VWWait()
    VWStraight(PSDGet(PSD_FRONT) - 150, 150)
    VWWait()
LCDPrintf("parked at %d %d\n", *VWGetPosition()[:2])
