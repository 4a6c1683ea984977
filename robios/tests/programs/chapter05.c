/* A robot that follows what is nearest by its lidar. */
#include "check.h"

int main(void)
{
    int scan[360], nearest, i, x, y, z, phi, lx, ly;

    while (OSGetCount() < 15000) {
        LIDARGet(scan);
        for (nearest = i = 0; i < 360; i++)
            if (scan[i] < scan[nearest])
                nearest = i;
        VWSetSpeed(scan[nearest] < 350 ? 0 : 300, 2 * (180 - nearest));
        OSWait(100);
    }
    SIMGetRobot(0, &x, &y, &z, &phi);
    SIMGetRobot(1, &lx, &ly, &z, &phi);
    CHECK(hypot(x - lx, y - ly) < 700);
    return 0;
}
