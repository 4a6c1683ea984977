#include "roam.h"

int main(int argc, char **argv)
{
    middle_line(duration(argc, argv));
    return VWSetSpeed(0, 0);
}
