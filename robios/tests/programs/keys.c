/* With the keys KEY2@1s,KEY1@2s,KEY4@4s,TOUCH:12:34@5s,IRTV_OK@6s */
#include "check.h"

int main(void)
{
    int x, y;

    CHECK(KEYRead() == NOKEY);
    CHECK(KEYGet() == KEY2);
    NEAR(OSGetCount(), 1000, 20);
    /* Presses of other keys than the one waited for are lost. */
    CHECK(KEYWait(KEY4) == KEY4);
    NEAR(OSGetCount(), 4000, 20);
    CHECK(KEYReadXY(&x, &y) != 0);
    CHECK(KEYGetXY(&x, &y) == 0 && x == 12 && y == 34);
    CHECK(IRTVGetStatus() == 1 && IRTVRead() == 0);
    CHECK(IRTVGet() == IRTV_OK);
    CHECK(IRTVFlush() == 0);
    return 0;
}
