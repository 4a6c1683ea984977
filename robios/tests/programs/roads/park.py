"""Parks between boxes on the right, as park.c does."""
import sys

from eye import *

ASIDE, LEAST, DEPTH, SENSOR = 300, 300, 250, 55

begin, end, beyond = None, None, False
VWSetSpeed(150, 0)
while end is None:
    is_box = PSDGet(PSD_RIGHT) < ASIDE
    x = VWGetPosition()[0]
    if x > 3000:
        sys.exit("no gap")
    if is_box and begin is not None and x - begin >= LEAST:
        end = x
    elif is_box:
        begin, beyond = None, True
    elif begin is None and beyond:
        begin = x
    OSWait(20)
VWSetSpeed(0, 0)
LCDPrintf("gap of %d mm\n" % (end - begin))
VWStraight((begin + end) // 2 + SENSOR - VWGetPosition()[0], 100)
VWWait()
VWTurn(-90, 45)
VWWait()
VWStraight(DEPTH, 100)
VWWait()
VWTurn(90, 45)
VWWait()
if PSDGet(PSD_FRONT) >= LEAST or PSDGet(PSD_BACK) >= LEAST:
    sys.exit("not between boxes")
