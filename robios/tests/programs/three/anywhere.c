#include "roam.h"

int main(int argc, char **argv)
{
    anywhere(duration(argc, argv));
    return VWSetSpeed(0, 0);
}
