#include "eyebot.h"
int main(void)
{
    LCDPrintf("busy\n");
    while (PSDGet(PSD_FRONT) > 0)
        ;
    return 0;
}
