/* Over hills: up the flank of the crater to its rim, or up the ramp, along the bank and down again. */
#include "check.h"

static int x, y, z, phi;

static void look(void)
{
    SIMGetRobot(0, &x, &y, &z, &phi);
}

static void straight(int distance)
{
    VWStraight(distance, 200);
    VWWait();
    look();
}

static void left(int angle)
{
    VWTurn(angle, 60);
    VWWait();
}

static void crater(void)
{
    int before, start;

    look();
    start = z;
    CHECK(start > 200);
    left(45);
    do {
        before = z;
        straight(100);
    } while (z > before);
    CHECK(z > start + 120 && x > 900 && y > 900);
}

static void levels(void)
{
    straight(1750);
    CHECK(z > 190 && x > 2500);
    left(90);
    straight(1700);
    CHECK(z > 190 && y > 2500);
    left(90);
    straight(1900);
    CHECK(z < 10 && x < 1200);
}

int main(void)
{
    look();
    if (x < 700)
        crater();
    else
        levels();
    LCDPrintf("z %d", z);
    return 0;
}
