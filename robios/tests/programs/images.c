#include "check.h"

int main(void)
{
    static BYTE col[QQVGA_SIZE], col2[QQVGA_SIZE], gray[QQVGA_PIXELS], out[QQVGA_PIXELS], h[QQVGA_PIXELS],
        s[QQVGA_PIXELS];
    BYTE r, g, b;
    int i;

    CHECK(IPSetSize(QQVGA) == 0 && IPSetSize(9) == 1);
    for (i = 0; i < QQVGA_PIXELS; i++) {
        col[3 * i] = 255;
        gray[i] = i % 160 < 80 ? 0 : 30;
    }
    IPCol2Gray(col, out);
    CHECK(out[77] == 63);
    IPGray2Col(gray, col2);
    CHECK(col2[3 * 100] == 30 && col2[3 * 100 + 2] == 30);
    IPLaplace(gray, out);
    CHECK(out[160 * 10 + 79] == 30 && out[160 * 10 + 80] == 30 && out[160 * 10 + 40] == 0);
    IPSobel(gray, out);
    CHECK(out[160 * 10 + 79] == 40 && out[160 * 10 + 20] == 0);
    IPCol2HSI(col, h, s, out);
    CHECK(h[5] == 42 && s[5] == 255 && out[5] == 63);
    IPRGB2Col(gray, h, s, col2);
    CHECK(col2[300] == 30 && col2[301] == 42 && col2[302] == 255);
    IPOverlay(col, col2, col2);
    CHECK(col2[301] == 42);
    IPOverlayGray(h, gray, GREEN, col2);
    CHECK(col2[3 * 100] == 0 && col2[3 * 100 + 1] == 255 && col2[0] == 42);
    CHECK(IPPRGB2Col(1, 2, 3) == 0x010203);
    IPPCol2RGB(0x0A0B0C, &r, &g, &b);
    CHECK(r == 10 && g == 11 && b == 12);
    IPPCol2HSI(GREEN, &r, &g, &b);
    CHECK(r == 126 && g == 255 && b == 127);
    IPPRGB2HSI(0, 0, 255, &r, &g, &b);
    CHECK(r == 210 && g == 255);
    CHECK(IPPRGB2Hue(90, 90, 90) == 0);
    CHECK(IPWriteFile("image.ppm", col) == 0 && IPReadFile("image.ppm", col2) == 3 && !memcmp(col, col2, sizeof col));
    CHECK(IPWriteFileGray("image.pgm", gray) == 0 && IPReadFile("image.pgm", out) == 2);
    CHECK(!memcmp(gray, out, sizeof gray));
    CHECK(IPReadFile("missing.ppm", out) == -1);
    return 0;
}
