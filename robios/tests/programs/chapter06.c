/* Twice along the walls of a square, by the distance to the left. */
#include "check.h"

int main(void)
{
    int corners = 0, closest = 9999, left;

    while (corners < 8) {
        left = PSDGet(PSD_LEFT);
        if (PSDGet(PSD_FRONT) < 300) {
            VWTurn(-90, 90);
            VWWait();
            corners++;
            continue;
        }
        if (corners > 0 && left < closest)
            closest = left;
        VWSetSpeed(200, (left < 1000 ? left : 250) > 250 ? 5 : -5);
        OSWait(50);
    }
    VWSetSpeed(0, 0);
    CHECK(closest > 50);
    LCDPrintf("at least %d mm\n", closest);
    return 0;
}
