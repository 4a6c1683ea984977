"""Straight by two motors and their encoders: the faster wheel is slowed down."""
from eye import *

GAIN = 0.05

for motor in (1, 2):
    ENCODERReset(motor)
left = right = 0
while left < 3000:
    left, right = ENCODERRead(1), ENCODERRead(2)
    difference = GAIN * (left - right)
    MOTORDrive(1, int(40 - difference))
    MOTORDrive(2, int(40 + difference))
    OSWait(20)
MOTORDrive(1, 0)
MOTORDrive(2, 0)
LCDPrintf("encoders %d %d\n", left, right)
