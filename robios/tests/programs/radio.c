/* Two robots send a number to and fro. */
#include "check.h"

#define ROUNDS 500

int main(void)
{
    char text[32];
    int ids[256], me, other, from = 0, i;

    CHECK(RADIOInit() == 0);
    me = RADIOGetID();
    other = 3 - me;
    CHECK(RADIOStatus(ids) == 2 && ids[0] == 1 && ids[1] == 2);
    CHECK(RADIOSend(other, "") == 1 && RADIOSend(7, "x") == 1 && RADIOCheck() == 0);
    if (me == 1)
        CHECK(RADIOSend(other, "0") == 0);
    for (i = 0; i < ROUNDS; i++) {
        CHECK(RADIOReceive(&from, text, sizeof text) == (int)strlen(text) && from == other);
        CHECK(atoi(text) == 2 * i + (me == 1));
        sprintf(text, "%d", atoi(text) + 1);
        CHECK(RADIOSend(other, text) == 0);
    }
    LCDPrintf("robot %d: %s\n", me, text);
    /* The first robot began, so its last message is left. */
    if (me == 2) {
        while (!RADIOCheck(&from))
            ;
        CHECK(from == 1 && RADIOCheck());
    }
    CHECK(RADIORelease() == 0);
    return 0;
}
