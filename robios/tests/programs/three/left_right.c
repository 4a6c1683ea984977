#include "roam.h"

int main(int argc, char **argv)
{
    left_right(duration(argc, argv));
    return VWSetSpeed(0, 0);
}
