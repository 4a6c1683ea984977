#include "check.h"

int main(void)
{
    static BYTE image[QVGA_SIZE];
    int x, y, row, column;

    CHECK(LCDPrintf("%s %d %5.2f|%-4d|%c", "text", 42, 3.14159, 7, 'x') == 0);
    CHECK(LCDSetPrintf(3, 10, "%03d", 7) == 0);
    CHECK(LCDGetPos(&row, &column) == 0 && row == 3 && column == 13);
    CHECK(LCDSetPos(5, 0) == 0);
    CHECK(LCDPrintf("row %ld\n", 5L) == 0);
    CHECK(LCDGetPos(&row, &column) == 0 && row == 6 && column == 0);
    CHECK(LCDGetSize(&x, &y) == 0 && x == 480 && y == 320);
    CHECK(LCDSetColor(RED, WHITE) == 0);
    CHECK(LCDSetFont(HELVETICA, BOLD) == 0 && LCDSetFontSize(18) == 0);
    CHECK(LCDPixel(100, 150, ORANGE) == 0 && LCDGetPixel(100, 150) == ORANGE);
    CHECK(LCDLine(0, 200, 9999, 200, GREEN) == 0 && LCDGetPixel(479, 200) == GREEN);
    CHECK(LCDLine(240, 100, 240, -9999, BLUE) == 0 && LCDGetPixel(240, 0) == BLUE);
    CHECK(LCDArea(300, 210, 320, 220, CYAN, 1) == 0 && LCDGetPixel(310, 215) == 0x00EEEE);
    CHECK(LCDArea(330, 210, 350, 220, CYAN, 0) == 0 && LCDGetPixel(340, 215) == BLACK);
    CHECK(LCDCircle(400, 100, 40, YELLOW, 1) == 0 && LCDGetPixel(400, 100) == YELLOW);
    CHECK(LCDMenu("GO", "", "", "END") == 0);
    CHECK(LCDMenuI(2, "TWO", WHITE, RED) == 0 && LCDMenuI(5, "FIVE", WHITE, RED) == 1);
    memset(image, 0x40, sizeof image);
    CHECK(LCDImageStart(0, 0, 320, 240) == 0 && LCDImage(image) == 0);
    CHECK(LCDGetPixel(319, 239) == 0x404040);
    CHECK(LCDImageGray(image) == 0 && LCDImageBinary(image) == 0 && LCDGetPixel(10, 10) == BLACK);
    CHECK(LCDImageSize(QQVGA) == 0 && LCDImage(image) == 0 && LCDImageSize(99) == 1);
    CHECK(LCDSetMode(LCD_NOAUTOREFRESH) == 0 && LCDRefresh() == 0);
    CHECK(LCDGetPixel(-1, 0) == 0 && LCDGetPixel(480, 0) == 0);
    return 0;
}
