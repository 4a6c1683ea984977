"""Keeps its distance to the wall ahead by a controller with three terms, and draws the error."""
from eye import *

WANTED, P, I, D = 500, 0.8, 0.005, 0.4

total, last = 0.0, 0.0
for step in range(200):
    error = PSDGet(PSD_FRONT) - WANTED
    total = max(-2000.0, min(2000.0, total + error * 0.05))
    VWSetSpeed(int(max(-250, min(250, P * error + I * total + D * (error - last)))), 0)
    last = error
    LCDPixel(2 * step, 200 - max(-100, min(150, error // 10)), YELLOW)
    OSWait(50)
VWSetSpeed(0, 0)
LCDSetPrintf(0, 0, "%d mm from the wall\n", PSDGet(PSD_FRONT))
