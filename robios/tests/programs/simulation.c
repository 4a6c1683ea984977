/* Robot 1 of two, and a can. */
#include "check.h"

int main(void)
{
    int x, y, z, phi, px, py, pphi;

    CHECK(SIMGetRobotCount() == 2 && SIMGetObjectCount() == 1);
    SIMGetRobot(0, &x, &y, &z, &phi);
    CHECK(x == 500 && y == 600 && phi == 90);
    SIMGetRobot(2, &x, &y, &z, &phi);
    CHECK(x == 1500 && y == 600 && phi == 180);
    SIMGetObject(1, &x, &y, &z, &phi);
    CHECK(x == 1000 && y == 1200);
    SIMSetObject(1, 1100, 1300, 0, 45);
    SIMGetObject(1, &x, &y, &phi);
    CHECK(x == 1100 && y == 1300 && phi == 45);
    SIMSetObject(1, 1200, 1300, 30);
    SIMGetObject(1, &x, &y, &z, &phi);
    CHECK(x == 1200 && phi == 30);
    SIMSetRobot(0, 700, 800, 0, -45);
    SIMGetPose(&px, &py, &pphi);
    CHECK(px == 700 && py == 800 && pphi == -45);
    SIMSetPose(800, 900, 10);
    SIMGetRobot(1, &x, &y, &z, &phi);
    CHECK(x == 800 && y == 900 && phi == 10);
    SIMGetRobot(9, &x, &y, &z, &phi);
    CHECK(x == 0 && y == 0 && z == 0 && phi == 0);
    /* Odometry does not notice. */
    VWGetPosition(&x, &y, &phi);
    CHECK(x == 0 && y == 0 && phi == 0);
    return 0;
}
