"""Chapter 8 from Python: a craft dives, and surfaces when its thrusters stop."""

from eye import *

PSD_DOWN = 6

OSWait(1000)
afloat = PSDGet(PSD_DOWN)
assert afloat > 500, afloat
for thruster in (2, 4):
    assert MOTORDrive(thruster, -100) == 0
OSWait(2500)
deep = PSDGet(PSD_DOWN)
assert deep < afloat - 300, (afloat, deep)
for thruster in (2, 4):
    MOTORDrive(thruster, 0)
OSWait(20000)
assert abs(PSDGet(PSD_DOWN) - afloat) < 60, (afloat, PSDGet(PSD_DOWN))
