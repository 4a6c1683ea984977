/* In the middle of a square, the scan has a peak towards each corner. */
#include "check.h"

int main(void)
{
    int scan[360], i, peaks = 0;

    LCDMenu("", "", "", "END");
    LIDARGet(scan);
    for (i = 0; i < 360; i++) {
        LCDLine(i, 250 - scan[i] / 10, i, 250, BLUE);
        if (scan[i] >= scan[(i + 359) % 360] && scan[i] > scan[(i + 1) % 360]) {
            LCDPrintf("peak at %d\n", 180 - i);
            NEAR((i + 45) % 90, 0, 1);
            peaks++;
        }
    }
    CHECK(peaks == 4);
    KEYWait(KEY4);
    return 0;
}
