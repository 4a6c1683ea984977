/* A car drives an S: motor 1 drives, servo 1 steers. */
#include "check.h"

int main(void)
{
    int x, y, z, phi, first;

    MOTORDrive(1, 60);
    SERVOSet(1, 0); /* left */
    OSWait(3000);
    SIMGetRobot(0, &x, &y, &z, &first);
    CHECK(first > 20);
    SERVOSet(1, 255);
    OSWait(4000);
    SIMGetRobot(0, &x, &y, &z, &phi);
    CHECK(phi < first - 20);
    SERVOSet(1, 128);
    MOTORDrive(1, 0);
    OSWait(2000);
    CHECK(LIDARGet((int[360]){0}) == 0);
    return 0;
}
