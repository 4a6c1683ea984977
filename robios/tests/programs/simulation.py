"""Radio, and the truth about the simulated world: two robots and a can."""

from eye import *

RADIOInit()
me = RADIOGetID()
count, ids = RADIOStatus()
assert count == 2 and list(ids[:2]) == [1, 2]
RADIOSend(3 - me, "from %d" % me)
while not RADIOCheck():
    OSWait(10)
assert RADIOReceive() == [3 - me, "from %d" % (3 - me)]
assert SIMGetRobotCount() == 2 and SIMGetObjectCount() == 1
# Objects are counted behind the robots; a robot's number means an object by its own count.
assert SIMGetObject(3) == SIMGetObject(1)
if me == 1:
    # What one robot changes, the other sees at once.
    OSWait(500)
    SIMSetRobot(0, 700, 800, 0, -45)
    x, y, z, phi = SIMGetRobot(0)
    assert (x.value, y.value, phi.value) == (700, 800, -45) and SIMGetPose() == [700, 800, -45]
    SIMSetObject(1, 2000, 2100, 0, 30)
    assert [value.value for value in SIMGetObject(1)] == [2000, 2100, 0, 30]
RADIORelease()
LCDPrintf("robot %d is done", me)
