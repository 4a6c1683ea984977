/* Dives, rises by itself and by its thrusters, as keys say, and notes at each key how far the floor is below. */
#include "eyebot.h"
#include <stdio.h>

#define FRONT 2
#define BACK 4
#define PSD_DOWN 6

static void vertical(int speed)
{
    MOTORDrive(FRONT, speed);
    MOTORDrive(BACK, speed);
}

int main(void)
{
    FILE *notes = fopen("down.txt", "w");
    int key;

    LCDMenu("Dive", "Stop", "Rise", "End");
    do {
        key = KEYGet();
        fprintf(notes, "%d\n", PSDGet(PSD_DOWN));
        vertical(key == KEY1 ? -100 : key == KEY3 ? 100 : 0);
    } while (key != KEY4);
    return fclose(notes);
}
