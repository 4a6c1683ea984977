/* Chapter 8: a craft in a pool dives, comes up by itself, comes up faster, and is driven by its level thrusters. */
#include "check.h"

#define LEFT 1
#define FRONT 2
#define RIGHT 3
#define BACK 4
#define PSD_DOWN 6

static void dive(int speed)
{
    CHECK(MOTORDrive(FRONT, speed) == 0 && MOTORDrive(BACK, speed) == 0);
}

static void drive(int left, int right)
{
    CHECK(MOTORDrive(LEFT, left) == 0 && MOTORDrive(RIGHT, right) == 0);
}

/* How far the ground has come away in some time. */
static int risen(int milliseconds)
{
    int before = PSDGet(PSD_DOWN);
    OSWait(milliseconds);
    return PSDGet(PSD_DOWN) - before;
}

int main(void)
{
    int afloat, x, y, phi, by_itself;

    OSWait(1000);
    afloat = PSDGet(PSD_DOWN);
    CHECK(afloat > 500);
    dive(-100);
    CHECK(risen(2500) < -300);
    dive(0);
    OSWait(2000);
    by_itself = risen(1000);
    CHECK(by_itself > 20);
    dive(100);
    OSWait(500);
    CHECK(risen(1000) > by_itself);
    OSWait(8000);
    NEAR(PSDGet(PSD_DOWN), afloat, 60);
    dive(0);
    drive(50, 50);
    OSWait(3000);
    VWGetPosition(&x, &y, &phi);
    CHECK(x > 300 && abs(y) < 50 && abs(phi) < 5);
    drive(-100, 100);
    OSWait(2000);
    VWGetPosition(&x, &y, &phi);
    CHECK(phi > 20);
    drive(100, -100);
    OSWait(6000);
    VWGetPosition(&x, &y, &phi);
    CHECK(phi < 20);
    VWSetSpeed(0, 0);
    OSWait(10000);
    VWGetPosition(&x, &y, &phi);
    VWStraight(500, 200);
    CHECK(VWWait() == 0);
    CHECK(ENCODERRead(LEFT) == 0);
    return 0;
}
