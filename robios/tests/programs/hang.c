#include "eyebot.h"
int main(void)
{
    LCDPrintf("hanging\n");
    for (;;)
        ;
}
