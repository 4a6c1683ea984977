"""Along the walls at a distance, by a proportional controller of one sensor."""
from eye import *

WANTED, GAIN, SPEED = 300, 0.15, 200

VWTurn(-90, 90)
VWWait()
VWSetSpeed(SPEED, 0)
while PSDGet(PSD_FRONT) > WANTED:
    OSWait(20)
VWSetSpeed(0, 0)
VWTurn(90, 90)
VWWait()

corners = 0
while corners < 3:
    if PSDGet(PSD_FRONT) < WANTED:
        VWSetSpeed(0, 0)
        VWTurn(90, 90)
        VWWait()
        corners += 1
        LCDPrintf("corner %d\n", corners)
    else:
        error = WANTED - PSDGet(PSD_RIGHT)
        VWSetSpeed(SPEED, int(max(-30, min(30, GAIN * error))))
        OSWait(50)
VWSetSpeed(0, 0)
