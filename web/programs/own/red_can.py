"""Looks for the red can by colour, and drives up to it."""
# robios --world=can.sim
from eye import *

CAMInit(QQVGA)


def red_column():
    """The middle of what is red in the image, and how many pixels are; none if few are."""
    image = CAMGet()
    columns = []
    for row in range(40, QQVGA_Y, 4):
        for column in range(0, QQVGA_X, 2):
            at = 3 * (row * QQVGA_X + column)
            r, g, b = image[at], image[at + 1], image[at + 2]
            if r > 80 and r > 2 * g and r > 2 * b:
                columns.append(column)
    return (sum(columns) / len(columns), len(columns)) if len(columns) > 5 else (None, 0)


for look in range(200):
    middle, count = red_column()
    if middle is None:
        VWSetSpeed(0, 40)
    elif PSDGet(PSD_FRONT) < 250:
        break
    else:
        VWSetSpeed(150, int((QQVGA_X / 2 - middle) / 2))
    OSWait(100)
VWSetSpeed(0, 0)
LCDPrintf("after %d looks: %d mm away\n", look, PSDGet(PSD_FRONT))
