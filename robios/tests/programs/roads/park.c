/* Parks between boxes on the right: past them along the road until a gap is long enough, back to its middle, and
 * into it. */
#include "check.h"

#define ASIDE 300 /* mm: nearer than this are boxes */
#define LEAST 300 /* mm: the robot's length, and room to turn */
#define DEPTH 250 /* mm from the lane to the middle of the spot */
#define SENSOR 55 /* mm from the robot's middle ahead to the sensor */

static int along(void)
{
    int x, y, phi;

    VWGetPosition(&x, &y, &phi);
    return x;
}

int main(void)
{
    int begin = -1, end = -1, beyond = 0;

    VWSetSpeed(150, 0);
    while (end < 0) {
        int is_box = PSDGet(PSD_RIGHT) < ASIDE;

        CHECK(along() < 3000);
        if (is_box && begin >= 0 && along() - begin >= LEAST)
            end = along();
        else if (is_box)
            begin = -1, beyond = 1;
        else if (begin < 0 && beyond)
            begin = along();
        OSWait(20);
    }
    VWSetSpeed(0, 0);
    LCDPrintf("gap of %d mm\n", end - begin);
    VWStraight((begin + end) / 2 + SENSOR - along(), 100);
    VWWait();
    VWTurn(-90, 45);
    VWWait();
    VWStraight(DEPTH, 100);
    VWWait();
    VWTurn(90, 45);
    VWWait();
    CHECK(PSDGet(PSD_FRONT) < LEAST && PSDGet(PSD_BACK) < LEAST);
    return 0;
}
