/* A lane's edge found in a picture, and signs by their colour. */
#include "check.h"

static BYTE image[QQVGA_SIZE], gray[QQVGA_PIXELS], edges[QQVGA_PIXELS];
static BYTE hue[QQVGA_PIXELS], saturation[QQVGA_PIXELS], intensity[QQVGA_PIXELS];

/* The column of the strongest edge in a row. */
static int edge_in(int row)
{
    int x, best = 1;

    for (x = 2; x < QQVGA_X - 2; x++)
        if (edges[row * QQVGA_X + x] > edges[row * QQVGA_X + best])
            best = x;
    return best;
}

int main(void)
{
    int i, x, y, row, red = 0, rounds;

    /* A bright line that leans to the right, and a red sign. */
    CHECK(IPSetSize(QQVGA) == 0);
    for (i = 0; i < QQVGA_PIXELS; i++) {
        x = i % QQVGA_X, y = i / QQVGA_X;
        BYTE shade = abs(x - (40 + y / 2)) < 4 ? 250 : 60;
        int sign = x > 120 && x < 140 && y > 20 && y < 40;
        image[3 * i] = sign ? 220 : shade, image[3 * i + 1] = image[3 * i + 2] = sign ? 20 : shade;
    }
    IPCol2Gray(image, gray);
    IPSobel(gray, edges);
    for (row = 50; row < 110; row += 10)
        NEAR(edge_in(row), 40 + row / 2, 6);
    IPCol2HSI(image, hue, saturation, intensity);
    for (i = 0; i < QQVGA_PIXELS; i++)
        red += saturation[i] > 150 && abs(hue[i] - IPPRGB2Hue(220, 20, 20)) < 10;
    CHECK(red == 19 * 19);
    IPOverlayGray(gray, edges, GREEN, image);
    LCDImageSize(QQVGA);
    CHECK(LCDImage(image) == 0);

    /* The same with the robot's own eyes, while it drives. */
    CAMInit(QQVGA);
    VWSetSpeed(100, 0);
    for (rounds = 0; rounds < 30; rounds++) {
        CHECK(CAMGet(image) == 0);
        IPCol2Gray(image, gray);
        IPSobel(gray, edges);
        VWSetSpeed(100, (QQVGA_X / 2 - edge_in(100)) / 10);
        LCDImageGray(edges);
    }
    VWSetSpeed(0, 0);
    CHECK(VWStalled() == 0);
    return 0;
}
