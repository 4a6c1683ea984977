/* The system's clocks and sleeps are the robot's. */
#include "check.h"
#include <sys/select.h>

int main(void)
{
    time_t start = time(NULL);
    struct timeval now, pause = {2, 0};
    struct timespec spec = {1, 500000000}, later;
    clock_t ticks;

    sleep(3);
    CHECK(time(NULL) - start == 3);
    usleep(500000);
    nanosleep(&spec, NULL);
    NEAR(OSGetCount(), 5000, 10);
    select(0, NULL, NULL, NULL, &pause);
    NEAR(OSGetCount(), 7000, 10);
    CHECK(gettimeofday(&now, NULL) == 0 && now.tv_sec - start == 7);
    CHECK(clock_gettime(CLOCK_MONOTONIC, &later) == 0 && later.tv_sec - start == 7);
    ticks = clock();
    while (clock() - ticks < CLOCKS_PER_SEC)
        ;
    while (time(NULL) - start < 12)
        ;
    NEAR(OSGetCount(), 12000, 10);
    return 0;
}
