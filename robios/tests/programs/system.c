#include "check.h"

static int calls;

static void count(void)
{
    calls++;
}

int main(void)
{
    char text[128];
    int hours, minutes, seconds, ticks, before;
    TIMER timer;

    CHECK(OSVersion(text) == 0 && strlen(text) > 0 && OSVersionIO(text) == 0);
    CHECK(OSMachineName(text) == 0 && strcmp(text, "EyeBot") == 0);
    CHECK(OSMachineSpeed() > 0 && OSMachineType() == VEHICLE && OSMachineID() == 1);
    CHECK(OSExecute("echo hello", text) == 0 && strcmp(text, "hello\n") == 0);
    before = OSGetCount();
    CHECK(OSWait(1500) == 0);
    NEAR(OSGetCount() - before, 1500, 5);
    CHECK(OSSetTime(23, 59, 59) == 0 && OSWait(1000) == 0);
    CHECK(OSGetTime(&hours, &minutes, &seconds, &ticks) == 0 && hours == 0 && minutes == 0 && seconds == 0);
    CHECK(OSSetTime(24, 0, 0) == 1);
    timer = OSAttachTimer(100, count);
    CHECK(timer > 0 && OSAttachTimer(0, count) == 0 && OSAttachTimer(10, NULL) == 0);
    OSWait(2050);
    NEAR(calls, 20, 1);
    CHECK(OSDetachTimer(timer) == 0 && OSDetachTimer(timer) == 1);
    before = calls;
    OSWait(1000);
    CHECK(calls == before);
    return 0;
}
