"""Drives, motors, servos and distance sensors."""

from eye import *

assert PSDGet(PSD_FRONT) > 100 and PSDGetRaw(PSD_LEFT) > 100 and PSDGet(77) == 0
scan = LIDARGet()
assert len(scan) == 360 and abs(scan[180] - PSDGet(PSD_FRONT)) < 100
assert LIDARSet(180, 0, 5) == 0 and len(LIDARGet()) == 5
assert VWStraight(200, 200) == 0 and VWDone() == 0 and VWRemain() > 150
while not VWDone():
    pass
assert VWWait() == 0 and abs(VWGetPosition()[0] - 200) <= 2
assert VWTurn(90, 90) == 0 and VWWait() == 0 and abs(VWGetPosition()[2] - 90) <= 1
assert VWCurve(100, -90, 100) == 0 and VWWait() == 0
assert VWDrive(100, 30, 100) == 0 and VWWait() == 0 and VWStalled() == 0
assert VWSetPosition(10, 20, 30) == 0
x, y, phi = ctypes.c_int(0), ctypes.c_int(0), ctypes.c_int(0)
assert VWGetPosition(x, y, phi) == [10, 20, 30] == [x.value, y.value, phi.value]
VWSetSpeed(100, 0)
OSWait(1000)
assert abs(VWGetSpeed()[0] - 100) <= 2
VWSetSpeed(0, 0)
OSWait(1000)
assert ENCODERReset(1) == 0 and MOTORDrive(1, 50) == 0 and MOTORDriveRaw(2, 50) == 0
OSWait(500)
assert ENCODERRead(1) > 100 and MOTORPID(1, 1, 1, 1) == 0 and MOTORPIDOff(1) == 0 and MOTORSpeed(1, 0) == 0
assert MOTORDrive(2, 0) == 0
assert SERVOSet(3, 200) == 0 and SERVOGet(3) == 200 and SERVORange(1, 10, 20) == 0 and SERVODone(3) == 1
