/* From A to B: by turn and straight, by an arc, and by correcting the heading on the way. */
#include "check.h"

static void back(void)
{
    SIMSetRobot(0, 1000, 1000, 0, 0);
    VWSetPosition(0, 0, 0);
}

static void arrived(int most)
{
    int x, y, z, phi;

    SIMGetRobot(0, &x, &y, &z, &phi);
    NEAR(x, 1800, most);
    NEAR(y, 1400, most);
    LCDPrintf("%d, %d\n", x, y);
}

int main(void)
{
    int x, y, phi, difference;

    back();
    VWTurn((int)(atan2(400, 800) * 180 / M_PI), 60);
    VWWait();
    VWStraight((int)sqrt(800.0 * 800 + 400 * 400), 300);
    VWWait();
    arrived(15);
    back();
    VWDrive(800, 400, 300);
    VWWait();
    arrived(15);
    back();
    for (;;) {
        VWGetPosition(&x, &y, &phi);
        if (hypot(800 - x, 400 - y) < 30)
            break;
        difference = (int)(atan2(400 - y, 800 - x) * 180 / M_PI) - phi;
        VWSetSpeed(150, 2 * difference);
        OSWait(50);
    }
    VWSetSpeed(0, 0);
    VWWait();
    arrived(60);
    return 0;
}
