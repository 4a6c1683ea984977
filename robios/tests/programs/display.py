"""The display."""

from eye import *

assert LCDPrintf("%d and %s|%5.2f\n", 42, "text", 2.5) == 0
assert LCDPrintf("100%%\n") == 0 and LCDPrintf("plain 50% text\n") == 0
assert LCDSetPrintf(5, 3, "%4.1f", 2.5) == 0 and LCDGetPos() == [5, 7]
row, column = ctypes.c_int(0), ctypes.c_int(0)
assert LCDGetPos(row, ctypes.byref(column)) == 0 and (row.value, column.value) == (5, 7)
assert LCDSetPos(8, 1) == 0 and LCDGetPos() == [8, 1]
assert LCDGetSize() == [480, 320]
assert LCDSetColor(RED, WHITE) == 0 and LCDSetFont(HELVETICA, BOLD) == 0 and LCDSetFontSize(14) == 0
assert LCDMenu("GO", "", "", "END") == 0 and LCDMenuI(2, "TWO", WHITE, BLUE) == 0
assert LCDPixel(100, 150, ORANGE) == 0 and LCDGetPixel(100, 150) == ORANGE
assert LCDPixelInvert(100, 150) == 0 and LCDGetPixel(100, 150) == 0xFFFFFF - ORANGE
assert LCDLine(0, 200, 9999, 200, GREEN) == 0 and LCDGetPixel(479, 200) == GREEN
assert LCDArea(300, 210, 320, 220, CYAN, 1) == 0 and LCDGetPixel(310, 215) == CYAN
assert LCDCircle(400, 100, 40, YELLOW, 1) == 0 and LCDGetPixel(400, 100) == YELLOW
# Images without a stated size have that of their window.
assert LCDImageStart(10, 10, 64, 32) == 0
assert LCDImageBinary([1] * (64 * 32)) == 0 and LCDGetPixel(20, 20) == BLACK
assert LCDImageGray(bytes([200] * (64 * 32))) == 0 and LCDGetPixel(20, 20) == 0xC8C8C8
assert LCDImageSize(QQVGA) == 0 and LCDImageStart(0, 0, 160, 120) == 0
assert LCDImage((ctypes.c_byte * QQVGA_SIZE)()) == 0 and LCDGetPixel(20, 20) == BLACK
assert LCDSetMode(LCD_NOAUTOREFRESH) == 0 and LCDRefresh() == 0 and LCDClear() == 0
LCDPrintf("done")
