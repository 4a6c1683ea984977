/* First programs: a greeting, a drive that ends before the wall, a picture, and two threads that share the robot. */
#include "check.h"

static pthread_mutex_t robot = PTHREAD_MUTEX_INITIALIZER;
static volatile int looks, over;

static void *look(void *unused)
{
    (void)unused;
    while (!over) {
        pthread_mutex_lock(&robot);
        LCDSetPrintf(10, 0, "ahead %4d mm", PSDGet(PSD_FRONT));
        looks++;
        pthread_mutex_unlock(&robot);
        usleep(100000);
    }
    return NULL;
}

int main(void)
{
    static BYTE image[QVGA_SIZE];
    pthread_t thread;
    int key, rounds = 0;

    LCDPrintf("Here I am\n");
    LCDMenu("GO", "", "", "END");
    CHECK(KEYGet() == KEY1);
    VWSetSpeed(200, 0);
    while (PSDGet(PSD_FRONT) > 300)
        OSWait(50);
    VWSetSpeed(0, 0);
    OSWait(500);
    CHECK(PSDGet(PSD_FRONT) > 200 && PSDGet(PSD_FRONT) < 310);
    CAMInit(QVGA);
    do {
        CHECK(CAMGet(image) == 0 && LCDImage(image) == 0);
        key = KEYRead();
    } while (key != KEY4 && ++rounds < 1000);
    CHECK(key == KEY4);
    XInitThreads();
    CHECK(pthread_create(&thread, NULL, look, NULL) == 0);
    sleep(2);
    over = 1;
    pthread_join(thread, NULL);
    CHECK(looks >= 10);
    return 0;
}
