#include "check.h"

int main(void)
{
    static BYTE image[VGA_SIZE], gray[VGA_PIXELS];
    int i, different = 0;

    CHECK(CAMGet(image) == 1); /* not started */
    CHECK(CAMInit(QVGA) == 0);
    CHECK(CAMWIDTH == 320 && CAMHEIGHT == 240 && CAMPIXELS == 76800 && CAMSIZE == 230400 && CAMMODE == QVGA);
    CHECK(CAMGet(image) == 0);
    for (i = 1; i < QVGA_SIZE; i++)
        different += image[i] != image[0];
    CHECK(different > 1000);
    CHECK(CAMGetGray(gray) == 0);
    CHECK(gray[5000] == (image[15000] + image[15002]) / 4 + image[15001] / 2);
    CHECK(CAMInit(VGA) == 0 && CAMWIDTH == 640 && CAMGet(image) == 0);
    CHECK(CAMInit(17) == 1 && CAMInit(-1) == 1);
    CHECK(CAMRelease() == 0 && CAMGet(image) == 1);
    return 0;
}
