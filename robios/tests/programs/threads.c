#include "check.h"

static int counts[3];

static void *busy(void *argument)
{
    int me = (int)(intptr_t)argument, i;

    for (i = 0; i < 20; i++) {
        CHECK(PSDGet(PSD_FRONT) > 0);
        usleep(50000);
        counts[me]++;
    }
    return NULL;
}

int main(void)
{
    pthread_t threads[3];
    intptr_t i;

    XInitThreads();
    for (i = 0; i < 3; i++)
        pthread_create(&threads[i], NULL, busy, (void *)i);
    OSWait(500);
    for (i = 0; i < 3; i++)
        pthread_join(threads[i], NULL);
    CHECK(counts[0] == 20 && counts[1] == 20 && counts[2] == 20);
    /* They slept at the same time. */
    CHECK(OSGetCount() >= 1000 && OSGetCount() < 4000);
    return 0;
}
