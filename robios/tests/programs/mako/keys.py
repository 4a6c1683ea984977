"""Dives, rises by itself and by its thrusters, as keys say, and notes at each key how far the floor is below."""
from eye import *

FRONT, BACK = 2, 4
PSD_DOWN = 6


def vertical(speed):
    MOTORDrive(FRONT, speed)
    MOTORDrive(BACK, speed)


LCDMenu("Dive", "Stop", "Rise", "End")
key = 0
with open("down.txt", "w") as notes:
    while key != KEY4:
        key = KEYGet()
        print(PSDGet(PSD_DOWN), file=notes)
        vertical({KEY1: -100, KEY3: 100}.get(key, 0))
