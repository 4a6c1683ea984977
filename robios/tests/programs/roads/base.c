/* The base station: draws the cars that it hears, stops them for some seconds once it has heard all of them, sees
 * that they obey, and ends their programs. */
#include "check.h"

#define CARS 8
#define STOP 6000 /* ms, from the first report of the last car */
#define GO 10000
#define END 14000
#define LONGEST 100000
#define PERIOD 200

static const int colours[] = {RED, GREEN, BLUE, YELLOW, CYAN, MAGENTA, ORANGE, WHITE};
static float xs[CARS + 1], ys[CARS + 1], speeds[CARS + 1];
static int heard[CARS + 1], stood[CARS + 1], went_on[CARS + 1], all, begin;

static void hear(void)
{
    char text[80], lane[16], intent[16];
    float x, y, phi, speed, bend;
    int id;

    while (RADIOCheck()) {
        RADIOReceive(&id, text, sizeof text);
        if (id > CARS || sscanf(text, "car %f %f %f %f %f %15s %15s", &x, &y, &phi, &speed, &bend, lane, intent) != 7)
            continue;
        stood[id] |= speed == 0;
        went_on[id] |= stood[id] && speed > 0;
        xs[id] = x, ys[id] = y, speeds[id] = speed;
        if (heard[id]++ == 0)
            all++, begin = OSGetCount();
    }
}

/* A metre is 60 pixels; cars begin in the middle. */
static void draw(void)
{
    int id, row = 0;

    for (id = 1; id <= CARS; id++) {
        if (!heard[id])
            continue;
        LCDPixel(240 + (int)(60 * xs[id]), 180 - (int)(60 * ys[id]), colours[id % CARS]);
        LCDSetPrintf(row++, 0, "car %d  %4.2f m/s  %d reports  ", id, speeds[id], heard[id]);
    }
}

int main(void)
{
    int ids[256], cars, i, due = 0, now = 0;

    RADIOInit();
    cars = RADIOStatus(ids) - 1;
    LCDMenu("STOP", "GO", "", "");
    while (now < END && OSGetCount() < LONGEST) {
        hear();
        draw();
        now = all < cars ? 0 : OSGetCount() - begin;
        if (OSGetCount() >= due) {
            RADIOSend(0, now > STOP && now < GO ? "stop" : "go");
            due = OSGetCount() + PERIOD;
        }
        OSWait(50);
    }
    RADIOSend(0, "end");
    CHECK(all == cars);
    for (i = 1; i <= CARS; i++)
        CHECK(!heard[i] || (heard[i] > 2 * END / 1000 && stood[i] && went_on[i]));
    return RADIORelease();
}
