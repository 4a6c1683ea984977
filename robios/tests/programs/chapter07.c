/* Mecanum wheels: forward, to the left, and on the spot. */
#include "check.h"

static void drive(int fl, int fr, int bl, int br)
{
    MOTORDrive(1, fl);
    MOTORDrive(2, fr);
    MOTORDrive(3, bl);
    MOTORDrive(4, br);
    OSWait(2000);
}

int main(void)
{
    int x, y, z, phi, x2, y2, phi2;

    SIMGetRobot(0, &x, &y, &z, &phi);
    drive(60, 60, 60, 60);
    drive(0, 0, 0, 0);
    SIMGetRobot(0, &x2, &y2, &z, &phi2);
    CHECK(x2 > x + 300 && abs(y2 - y) < 5 && phi2 == phi);
    drive(-60, 60, 60, -60);
    drive(0, 0, 0, 0);
    SIMGetRobot(0, &x, &y, &z, &phi);
    CHECK(y > y2 + 300 && abs(x - x2) < 5 && phi2 == phi);
    drive(-60, 60, -60, 60);
    drive(0, 0, 0, 0);
    SIMGetRobot(0, &x2, &y2, &z, &phi2);
    CHECK(phi2 != phi && abs(x - x2) < 5 && abs(y - y2) < 5);
    return 0;
}
