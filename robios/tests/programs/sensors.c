/* In a room of 4 m x 4 m, from 1000,2000 along x. Walls are 10 mm thick. */
#include "check.h"

int main(void)
{
    int scan[360], few[5], i;

    NEAR(PSDGet(PSD_FRONT), 2935, 3);
    NEAR(PSDGet(PSD_LEFT), 1950, 3);
    NEAR(PSDGet(PSD_RIGHT), 1950, 3);
    NEAR(PSDGet(PSD_BACK), 935, 3);
    CHECK(PSDGet(99) == 0 && PSDGet(-1) == 0 && PSDGetRaw(PSD_FRONT) == PSDGet(PSD_FRONT));
    CHECK(LIDAR_RESOLUTION == 360 && LIDARGet(scan) == 0);
    NEAR(scan[0], 995, 3);
    NEAR(scan[90], 1995, 3);
    NEAR(scan[180], 2995, 3);
    NEAR(scan[270], 1995, 3);
    /* Clockwise: turned to the left, the near wall behind is on the right. */
    CHECK(VWTurn(90, 90) == 0 && VWWait() == 0);
    CHECK(SIMLaserScan(scan) == 0);
    NEAR(scan[90], 995, 15);
    NEAR(scan[270], 2995, 15);
    CHECK(LIDARSet(180, 0, 5) == 0 && LIDAR_RESOLUTION == 5 && LIDARGet(few) == 0);
    NEAR(few[0], 995, 15);
    NEAR(few[2], 1995, 15);
    NEAR(few[4], 2995, 15);
    CHECK(LIDARSet(-3, 0, 5) == 1 && LIDARSet(180, -91, 5) == 1 && LIDARSet(0, 0, 5) == 1 && LIDARSet(180, 0, 0) == 1 && LIDARSet(180, 0, 2000000000) == 1);
    for (i = 0; i < 100; i++)
        CHECK(LIDARGet(few) == 0);
    return 0;
}
