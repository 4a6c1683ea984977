/* A minute of driving with 20,000 calls. */
#include "check.h"

int main(void)
{
    int x, y, phi, i;

    VWSetSpeed(100, 60);
    for (i = 0; i < 5000; i++) {
        VWGetPosition(&x, &y, &phi);
        PSDGet(PSD_FRONT);
        KEYRead();
        OSWait(12);
    }
    VWSetSpeed(0, 0);
    CHECK(OSGetCount() >= 60000);
    return 0;
}
