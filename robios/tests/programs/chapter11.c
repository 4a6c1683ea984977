/* Edges of what the camera sees, and motion while something moves. */
#include "check.h"

int main(void)
{
    static BYTE image[QVGA_SIZE], gray[QVGA_PIXELS], edges[QVGA_PIXELS], before[QVGA_PIXELS];
    int i, strong = 0, moved = 0, same = 0;

    LCDMenu("", "", "", "END");
    CAMInit(QVGA);
    CAMGet(image);
    IPCol2Gray(image, gray);
    IPLaplace(gray, edges);
    for (i = 0; i < QVGA_PIXELS; i++)
        strong += edges[i] > 50;
    CHECK(strong > 50);
    IPOverlayGray(gray, edges, RED, image);
    LCDImage(image);
    CAMGetGray(before);
    VWTurn(10, 20);
    VWWait();
    CAMGetGray(gray);
    for (i = 0; i < QVGA_PIXELS; i++)
        moved += abs(gray[i] - before[i]) > 20;
    CAMGetGray(before);
    for (i = 0; i < QVGA_PIXELS; i++)
        same += abs(gray[i] - before[i]) > 20;
    CHECK(moved > 500 && same == 0);
    LCDSetPrintf(18, 0, "%d moved", moved);
    while (KEYRead() != KEY4)
        CAMGet(image), LCDImage(image);
    return 0;
}
