/* Threads that sleep do so side by side, however busy the machine is; one that computes gets its time to. */
#include "check.h"

static volatile int rounds[3], sum, over;

static void *sleeper(void *number)
{
    int index = (int)(intptr_t)number;

    while (!over) {
        usleep(100000);
        rounds[index]++;
    }
    return NULL;
}

static void *computes(void *unused)
{
    long i;

    (void)unused;
    while (!over) {
        for (i = 0; i < 20000; i++)
            sum += (int)i;
        OSWait(100);
        rounds[2]++;
    }
    return NULL;
}

int main(void)
{
    pthread_t threads[3];
    int i;

    for (i = 0; i < 3; i++)
        CHECK(pthread_create(&threads[i], NULL, i < 2 ? sleeper : computes, (void *)(intptr_t)i) == 0);
    sleep(5);
    over = 1;
    for (i = 0; i < 3; i++) {
        pthread_join(threads[i], NULL);
        NEAR(rounds[i], 50, 2);
    }
    return 0;
}
