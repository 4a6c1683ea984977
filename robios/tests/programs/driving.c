#include "check.h"

int main(void)
{
    int x, y, phi, v, w;

    CHECK(VWGetPosition(&x, &y, &phi) == 0 && x == 0 && y == 0 && phi == 0);
    CHECK(VWStraight(500, 250) == 0);
    CHECK(VWDone() == 0);
    NEAR(VWRemain(), 500, 5);
    OSWait(1000);
    CHECK(VWGetSpeed(&v, &w) == 0);
    NEAR(v, 250, 10);
    CHECK(VWWait() == 0 && VWDone() == 1 && VWRemain() == 0 && VWStalled() == 0);
    VWGetPosition(&x, &y, &phi);
    NEAR(x, 500, 3);
    NEAR(y, 0, 1);
    CHECK(VWTurn(-90, 90) == 0 && VWWait() == 0);
    VWGetPosition(&x, &y, &phi);
    NEAR(phi, -90, 1);
    CHECK(VWCurve(471, 90, 200) == 0 && VWWait() == 0); /* a quarter of a circle of 300 mm */
    VWGetPosition(&x, &y, &phi);
    NEAR(x, 800, 6);
    NEAR(y, -300, 6);
    NEAR(phi, 0, 1);
    CHECK(VWSetPosition(0, 0, 90) == 0);
    CHECK(VWDrive(300, 300, 200) == 0 && VWWait() == 0);
    VWGetPosition(&x, &y, &phi);
    NEAR(x, -300, 6);
    NEAR(y, 300, 6);
    NEAR(abs(phi), 180, 1);
    CHECK(VWStraight(-200, 200) == 0 && VWWait() == 0);
    VWGetPosition(&x, &y, &phi);
    NEAR(x, -100, 8);
    CHECK(VWSetSpeed(100, 0) == 0);
    OSWait(500);
    CHECK(VWStraight(100, 0) == 1);
    CHECK(VWSetSpeed(0, 0) == 0 && VWControl(1, 2, 3, 4) == 0 && VWControlOff() == 0);
    return 0;
}
