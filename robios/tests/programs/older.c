/* Names of the first years. */
#include "check.h"

static SEMA semaphore;
static int count;

static void *work(void *argument)
{
    int i;

    for (i = 0; i < 5; i++) {
        SEMALock(&semaphore);
        count += (int)(intptr_t)argument;
        SEMAUnlock(&semaphore);
        MTSleep(10);
    }
    return NULL;
}

int main(void)
{
    TASK task;

    CHECK(LCDInit() == 0 && LCDClear() == 0);
    CHECK(LCDPixelInvert(5, 5) == 0 && LCDGetPixel(5, 5) == WHITE);
    CHECK(LCDAreaInvert(0, 0, 9, 9) == 0 && LCDGetPixel(5, 5) == BLACK && LCDGetPixel(9, 9) == WHITE);
    CHECK(LCDLineInvert(20, 20, 40, 30) == 0 && LCDGetPixel(20, 20) == WHITE && LCDGetPixel(40, 30) == WHITE);
    CHECK(LCDCircleInvert(100, 100, 5) == 0 && LCDGetPixel(105, 100) == WHITE && LCDGetPixel(106, 100) == BLACK);
    CHECK(LCDLineInvert(INT32_MIN, 0, INT32_MAX, 9) == 0 && LCDAreaInvert(INT32_MIN, 0, INT32_MAX, INT32_MAX) == 0);
    CHECK(VWStraight(100, 100) == 0 && VWDriveDone() == 0 && VWDriveRemain() > 50);
    CHECK(VWDriveWait() == 0 && VWDriveDone() == 1);
    CHECK(AUTone(440, 10) == 0 && AUCheckTone() == 0 && AUCheckPlay() == 0 && AUCheckRecord() == 1);
    CHECK(MTInit() == 0 && SEMAInit(&semaphore, 1) == 0 && SEMAInit(NULL, 1) == 1 && SEMALock(NULL) == 1);
    task = MTSpawn(work, 7);
    CHECK(MTGetUID(task) == 7);
    MTSleep(100);
    CHECK(count == 35);
    return 0;
}
