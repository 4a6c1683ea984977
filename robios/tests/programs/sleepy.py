"""Without the module: the runner makes time virtual, and a name that an editor has garbled leads to it."""

from time import sleep, time
from random.eye import *

start = time()
sleep(100)
assert abs(time() - start - 100) < 0.1
VWSetSpeed(0, 0)
LCDPrintf("slept %d s\n" % (OSGetCount() // 1000))
