"""What three robots that drive about in one room have in common: they look round by lidar, and back up before
whatever is near, the others included."""

import random
import sys

from eye import *

# Least distance from the lidar to what is ahead, and to what is beside, in millimetres.
AHEAD, BESIDE = 220, 120


def near(scan, forwards, degrees):
    """Smallest distance within some degrees of straight ahead, or of straight back."""
    if forwards:
        return min(scan[180 - degrees:181 + degrees])
    return min(scan[:degrees + 1] + scan[360 - degrees:])


def drive(speed, turn=0):
    """Drives on, backwards if the speed is negative, or stops before something. Returns whether it drives."""
    scan = list(LIDARGet())
    is_free = near(scan, speed > 0, 60) > AHEAD and near(scan, speed > 0, 100) > BESIDE
    VWSetSpeed(speed if is_free else 0, turn if is_free else 0)
    return is_free


def back_up_and_turn(angle):
    """Backs up, as far as there is room behind, and turns."""
    until = OSGetCount() + 1000
    while OSGetCount() < until and drive(-100):
        pass
    VWTurn(angle, 90)
    VWWait()


def duration():
    """Milliseconds to drive: five minutes, or as many seconds as the command line says."""
    return 1000 * int(sys.argv[1]) if len(sys.argv) > 1 else 300000


def left_right(milliseconds):
    """To and fro. The turns alternate, so that what they are wrong by cancels out."""
    side = 1
    while OSGetCount() < milliseconds:
        if not drive(150):
            back_up_and_turn(180 * side)
            side = -side
    VWSetSpeed(0, 0)


def middle_line(milliseconds):
    """Up and down on the line on which it has started."""
    side = 1
    while OSGetCount() < milliseconds:
        _, y, phi = VWGetPosition()
        error = ((phi if side > 0 else phi - 180) + 540) % 360 - 180
        if not drive(150, max(-30, min(30, -error - side * y // 5))):
            back_up_and_turn(180 * side)
            side = -side
    VWSetSpeed(0, 0)


def anywhere(milliseconds):
    """Straight on, and after each obstacle in any other direction."""
    random.seed(1)
    while OSGetCount() < milliseconds:
        if not drive(150):
            back_up_and_turn(random.randrange(90, 270))
    VWSetSpeed(0, 0)
