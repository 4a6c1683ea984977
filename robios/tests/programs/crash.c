#include "eyebot.h"
int main(void)
{
    LCDPrintf("before\n");
    VWStraight(100, 100);
    VWWait();
    raise(SIGSEGV);
    return 0;
}
