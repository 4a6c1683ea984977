"""A timer that notes the way beside what the program does."""
from eye import *

trace = []


def note():
    trace.append(tuple(VWGetPosition()[:2]))


timer = OSAttachTimer(500, note)
VWStraight(800, 200)
VWWait()
VWCurve(800, 180, 200)
VWWait()
OSDetachTimer(timer)
for place in trace:
    LCDPrintf("%d,%d\n", *place)
