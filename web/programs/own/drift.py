"""How far odometry is from the truth after each lap."""
# robios --noise=1 --seed=3
from math import hypot

from eye import *

start = [int(value) for value in SIMGetRobot(1)]
for lap in range(3):
    for side in range(4):
        VWStraight(500, 300)
        VWWait()
        VWTurn(90, 120)
        VWWait()
    x, y, phi = VWGetPosition()
    true_x, true_y = (int(value) for value in SIMGetRobot(1)[:2])
    LCDPrintf("lap %d: %d mm off\n", lap + 1, hypot(true_x - start[0] - x, true_y - start[1] - y))
