/* A way around a wall by lidar and odometry, and a square that is divided until its parts are free or full. */
#include "check.h"

#define GOAL_X 2000
#define SIDE 64

static BYTE map[SIDE][SIDE];
static int free_parts, full_parts;

static void divide(int x, int y, int size)
{
    int i, j, full = 0;

    for (i = y; i < y + size; i++)
        for (j = x; j < x + size; j++)
            full += map[i][j];
    if (full == 0 || full == size * size) {
        *(full ? &full_parts : &free_parts) += 1;
        LCDArea(x, y, x + size - 1, y + size - 1, full ? RED : GREEN, 0);
        return;
    }
    divide(x, y, size / 2), divide(x + size / 2, y, size / 2);
    divide(x, y + size / 2, size / 2), divide(x + size / 2, y + size / 2, size / 2);
}

int main(void)
{
    int scan[360], x, y, phi, i, j, ahead, steps = 0;

    for (i = 0; i < 16; i++)
        for (j = 32; j < 48; j++)
            map[i][j] = 1;
    LCDImageStart(0, 0, SIDE, SIDE);
    CHECK(LCDImageBinary(&map[0][0]) == 0);
    CHECK(LCDGetPixel(40, 5) == BLACK && LCDGetPixel(5, 5) == WHITE);
    divide(0, 0, SIDE);
    CHECK(full_parts == 1 && free_parts == 6);

    do {
        VWGetPosition(&x, &y, &phi);
        LIDARGet(scan);
        ahead = scan[180];
        for (i = 150; i <= 210; i++)
            if (scan[i] < ahead)
                ahead = scan[i];
        if (ahead < 350)
            VWSetSpeed(80, 60);
        else {
            int error = (int)round(atan2(-y, GOAL_X - x) * 180 / M_PI) - phi;
            /* It turns back to the goal once the wall is behind its right side. */
            VWSetSpeed(200, scan[270] < 400 && error < 0 ? 0 : error > 45 ? 45 : error < -45 ? -45 : error);
        }
        LCDSetPrintf(12, 0, "%5d %5d %4d", x, y, phi);
        OSWait(50);
    } while (hypot(GOAL_X - x, y) > 80 && ++steps < 2000);
    VWSetSpeed(0, 0);
    CHECK(steps < 2000);
    return 0;
}
