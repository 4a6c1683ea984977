/* The system's clocks and sleeps are the robot's. */
#include "check.h"
#include <poll.h>
#include <sys/select.h>
#include <threads.h>

static volatile int rings;

static void ring(int number)
{
    (void)number;
    rings++;
}

int main(void)
{
    time_t start = time(NULL);
    struct timeval now, two = {2, 0};
    struct timespec spec = {1, 500000000}, later;
    struct itimerval twice = {{0, 500000}, {1, 0}}, never = {{0, 0}, {0, 0}}, rest;
    clock_t ticks;

    sleep(3);
    CHECK(time(NULL) - start == 3);
    usleep(500000);
    nanosleep(&spec, NULL);
    NEAR(OSGetCount(), 5000, 10);
    select(0, NULL, NULL, NULL, &two);
    NEAR(OSGetCount(), 7000, 10);
    CHECK(gettimeofday(&now, NULL) == 0 && now.tv_sec - start == 7);
    CHECK(clock_gettime(CLOCK_MONOTONIC, &later) == 0 && later.tv_sec - start == 7);
    ticks = clock();
    while (clock() - ticks < CLOCKS_PER_SEC)
        ;
    while (time(NULL) - start < 12)
        ;
    NEAR(OSGetCount(), 12000, 10);
    CHECK(poll(NULL, 0, 1000) == 0 && thrd_sleep(&spec, NULL) == 0);
    CHECK(timespec_get(&later, TIME_UTC) == TIME_UTC && later.tv_sec - start == 14);
    signal(SIGALRM, ring);
    CHECK(setitimer(ITIMER_REAL, &twice, NULL) == 0);
    OSWait(1200);
    CHECK(rings == 1 && getitimer(ITIMER_REAL, &rest) == 0 && rest.it_interval.tv_usec == 500000);
    NEAR((int)rest.it_value.tv_usec, 300000, 10000);
    while (rings < 4)
        pause();
    CHECK(setitimer(ITIMER_REAL, &never, &rest) == 0 && alarm(5) == 0 && alarm(0) == 5);
    return 0;
}
