/* Timers' functions are called while the program calls, sleeps, and does nothing at all. */
#include "check.h"

static volatile int calls;

static void tick(void)
{
    calls++;
    PSDGet(PSD_FRONT);
}

int main(void)
{
    TIMER timer = OSAttachTimer(50, tick);
    int before;

    CHECK(timer > 0);
    OSWait(1010);
    NEAR(calls, 20, 1);
    before = calls;
    while (OSGetCount() < 2000)
        ;
    NEAR(calls - before, 20, 2);
    before = calls;
    while (calls < before + 50)
        ;
    NEAR(OSGetCount(), 4500, 600);
    CHECK(OSDetachTimer(timer) == 0 && OSDetachTimer(timer) == 1);
    before = calls;
    OSWait(500);
    CHECK(calls == before);
    return 0;
}
