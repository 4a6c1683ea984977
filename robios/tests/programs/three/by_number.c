/* One program for three robots: which one it is tells the robot what to do. */
#include "roam.h"

int main(int argc, char **argv)
{
    int milliseconds = duration(argc, argv);

    switch (OSMachineID()) {
    case 1:
        left_right(milliseconds);
        break;
    case 2:
        middle_line(milliseconds);
        break;
    default:
        anywhere(milliseconds);
    }
    return VWSetSpeed(0, 0);
}
