/* Threads that wake each other by conditions, barriers, semaphores and locks, and call RoBIOS at once. */
#include "check.h"
#include <semaphore.h>

#define TEAM 4

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER, held = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t filled = PTHREAD_COND_INITIALIZER, taken = PTHREAD_COND_INITIALIZER;
static pthread_barrier_t barrier;
static pthread_rwlock_t shared = PTHREAD_RWLOCK_INITIALIZER;
static sem_t turns[2];
static int item = -1;

/* Takes items off a place for one, whichever worker wakes first. */
static void *work(void *number)
{
    int i;

    for (i = 0; i < 5; i++) {
        pthread_mutex_lock(&lock);
        while (item < 0)
            pthread_cond_wait(&filled, &lock);
        LCDPrintf("%d:%d@%d ", (int)(intptr_t)number, item, OSGetCount());
        item = -1;
        pthread_cond_signal(&taken);
        pthread_mutex_unlock(&lock);
        if (i % 2)
            PSDGet(PSD_FRONT);
    }
    return NULL;
}

/* All leave the barrier at once. */
static void *meet(void *number)
{
    int i, last = 0;

    for (i = 0; i < 5; i++) {
        OSWait(10 * (int)(intptr_t)number);
        last += pthread_barrier_wait(&barrier) == PTHREAD_BARRIER_SERIAL_THREAD;
        LCDPrintf("%d/%d ", (int)(intptr_t)number, OSGetCount());
        VWSetSpeed(10 * (int)(intptr_t)number, 0);
    }
    return (void *)(intptr_t)last;
}

/* The other one may only follow. */
static void *alternate(void *number)
{
    int i, me = (int)(intptr_t)number;

    for (i = 0; i < 10; i++) {
        sem_wait(&turns[me]);
        LCDPrintf("%c%d ", 'A' + me, PSDGet(PSD_LEFT));
        sem_post(&turns[1 - me]);
    }
    return NULL;
}

/* Holds a lock while it waits, and takes it again at once: the others get it all the same. */
static void *hold(void *number)
{
    int i;

    for (i = 0; i < 4; i++) {
        pthread_mutex_lock(&held);
        LCDPrintf("h%d@%d ", (int)(intptr_t)number, OSGetCount());
        OSWait(20);
        pthread_mutex_unlock(&held);
    }
    return NULL;
}

static void *publish(void *number)
{
    int i;

    for (i = 0; i < 4; i++) {
        if (number == NULL)
            pthread_rwlock_wrlock(&shared);
        else
            pthread_rwlock_rdlock(&shared);
        OSWait(15);
        LCDPrintf("%c%d ", number == NULL ? 'w' : 'r', OSGetCount());
        pthread_rwlock_unlock(&shared);
    }
    return NULL;
}

static int together(void *(*body)(void *), int count)
{
    pthread_t threads[TEAM];
    void *result;
    intptr_t i;
    int sum = 0;

    for (i = 0; i < count; i++)
        CHECK(pthread_create(&threads[i], NULL, body, (void *)i) == 0);
    if (body == work) {
        for (i = 0; i < 5 * TEAM; i++) {
            pthread_mutex_lock(&lock);
            while (item >= 0)
                pthread_cond_wait(&taken, &lock);
            item = (int)i;
            if (i % 3)
                pthread_cond_signal(&filled);
            else
                pthread_cond_broadcast(&filled);
            pthread_mutex_unlock(&lock);
        }
    }
    for (i = 0; i < count; i++) {
        CHECK(pthread_join(threads[i], &result) == 0);
        sum += (int)(intptr_t)result;
    }
    return sum;
}

int main(void)
{
    struct timespec end;
    int begin;

    CHECK(pthread_barrier_init(&barrier, NULL, TEAM) == 0);
    sem_init(&turns[0], 0, 1);
    sem_init(&turns[1], 0, 0);
    together(work, TEAM);
    CHECK(together(meet, TEAM) == 5);
    together(alternate, 2);
    together(hold, 3);
    together(publish, 3);
    pthread_barrier_destroy(&barrier);

    /* Waits with a time limit go by the program's clock. */
    begin = OSGetCount();
    clock_gettime(CLOCK_REALTIME, &end);
    end.tv_sec += 30;
    CHECK(sem_timedwait(&turns[1], &end) == -1 && errno == ETIMEDOUT);
    CHECK(OSGetCount() - begin >= 29999 && OSGetCount() - begin <= 30050);
    return 0;
}
