/* Four thrusters: what a program for a submarine asks of a robot without water under it is answered. */
#include "check.h"

#define LEFT 1
#define FRONT 2
#define RIGHT 3
#define BACK 4
#define PSD_DOWN 6

static int thrust(int front, int back, int left, int right)
{
    return MOTORDrive(FRONT, front) + MOTORDrive(BACK, back) + MOTORDrive(LEFT, left) + MOTORDrive(RIGHT, right);
}

int main(void)
{
    int key, pressed = 0, rounds = 0;

    LCDMenu("DIVE", "STOP", "UP", "END");
    do {
        LCDSetPrintf(19, 0, "below: %6d\n", PSDGet(PSD_DOWN));
        switch (key = KEYRead()) {
        case KEY1: CHECK(thrust(-100, -100, 0, 0) == 0); break;
        case KEY2: CHECK(thrust(0, 0, 0, 0) == 0); break;
        case KEY3: CHECK(thrust(0, 0, 50, 50) == 0); break;
        }
        if (key != NOKEY) {
            pressed |= key;
            OSWait(500);
            thrust(0, 0, 0, 0);
        }
        OSWait(20);
    } while (key != KEY4 && ++rounds < 10000);
    CHECK(pressed == (KEY1 | KEY2 | KEY3 | KEY4));
    CHECK(PSDGet(PSD_DOWN) == 0);
    return 0;
}
