"""A car that keeps in its lane by the line on its right, tells where it is, and obeys the base station, as car.c does."""
import sys
from math import radians

from eye import *

HEIGHT, PIXELS, SPEED, BRIGHT, PERIOD, LONGEST = 60, 277, 150, 60, 200, 120000
ROWS = (155, 170, 185)


def line_in(image, row):
    """Distance on the floor to the first line to the right of the middle, in mm; None without one."""
    ahead = HEIGHT * PIXELS // (row - QVGA_Y // 2)
    pixels = bytes(image[row * QVGA_X + QVGA_X // 2:(row + 1) * QVGA_X])
    for x in range(len(pixels) - 2):
        if min(pixels[x], pixels[x + 1]) > pixels[0] + BRIGHT:
            return x * ahead // PIXELS
    return None


def report(station, stands):
    """Tells the base station where the car is."""
    x, y, phi = VWGetPosition()
    speed, intent = (0, "stand") if stands else (SPEED / 1000, "drive")
    RADIOSend(station, "car %.3f %.3f %.2f %.2f 0 own %s" % (x / 1000, y / 1000, radians(phi), speed, intent))


def hear(station, order):
    """The number of the base station, once it has been heard, and its last order."""
    while RADIOCheck():
        station, order = RADIOReceive(80)
    return station, order


CAMInit(QVGA)
RADIOInit()
image = CAMGetGray()
middle = [line_in(image, row) for row in ROWS]
if None in middle:
    sys.exit("no line to the right: %s" % middle)
due, station, order, turn = 0, 0, "go", 0
while OSGetCount() < LONGEST:
    station, order = hear(station, order)
    if order == "end":
        break
    stopped = order == "stop"
    image = CAMGetGray()
    lines = [(line_in(image, row), at) for row, at in zip(ROWS, middle)]
    off = [line - at for line, at in lines if line is not None and abs(line - at) < at]
    # An arc to a place 340 mm ahead, as far beside the car as the lane's middle is; without a line, the same
    # arc as before.
    if off:
        turn = round(-sum(off) / len(off) * 2 * SPEED * 57 / 340**2)
    VWSetSpeed(0 if stopped else SPEED, 0 if stopped else turn)
    if station and OSGetCount() >= due:
        report(station, stopped)
        due = OSGetCount() + PERIOD
    OSWait(30)
RADIORelease()
VWSetSpeed(0, 0)
