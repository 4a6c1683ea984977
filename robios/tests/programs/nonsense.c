/* Writes garbage where the library asks the world. */
#include "eyebot.h"

int main(void)
{
    char line[256], *start = NULL;
    FILE *maps = fopen("/proc/self/maps", "r");

    XInitThreads();
    while (maps != NULL && start == NULL && fgets(line, sizeof line, maps) != NULL)
        if (strstr(line, "memfd:robios") != NULL)
            start = (char *)strtoul(line, NULL, 16);
    if (start == NULL)
        return 0;
    /* A length that cannot be, and the other side's turn. */
    *(volatile unsigned *)(start + 128) = 0x7b7b7b7b;
    *(volatile unsigned *)(start + 64) = 1;
    for (;;)
        pause();
}
