"""Over hills: up the flank of the crater to its rim, or up the ramp, along the bank and down again."""

from eye import *


def look():
    return [int(value.value) for value in SIMGetRobot(0)]


def straight(distance):
    VWStraight(distance, 200)
    VWWait()
    return look()


def left(angle):
    VWTurn(angle, 60)
    VWWait()


x, y, z, phi = look()
if x < 700:
    start, before = z, 0
    assert start > 200
    left(45)
    while z > before:
        before = z
        x, y, z, phi = straight(100)
    assert z > start + 120 and x > 900 and y > 900, (x, y, z)
else:
    x, y, z, phi = straight(1750)
    assert z > 190 and x > 2500, (x, y, z)
    left(90)
    x, y, z, phi = straight(1700)
    assert z > 190 and y > 2500, (x, y, z)
    left(90)
    x, y, z, phi = straight(1900)
    assert z < 10 and x < 1200, (x, y, z)
LCDPrintf("z %d", z)
