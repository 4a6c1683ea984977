/* Out of a maze with a hand on the left wall. */
#include "check.h"

#define CELL 360

int main(void)
{
    int x, y, z, phi, steps;

    for (steps = 0; steps < 60; steps++) {
        SIMGetRobot(0, &x, &y, &z, &phi);
        if (x > 3 * CELL && y > 2 * CELL)
            break;
        if (PSDGet(PSD_LEFT) > 200)
            VWTurn(90, 90), VWWait();
        while (PSDGet(PSD_FRONT) < 250)
            VWTurn(-90, 90), VWWait();
        VWStraight(CELL, 300);
        VWWait();
    }
    CHECK(steps < 60);
    LCDPrintf("%d steps\n", steps);
    return 0;
}
