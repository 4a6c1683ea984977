/* What three robots that drive about in one room have in common: they look round by lidar, and back up before
   whatever is near, the others included. */
#include "eyebot.h"
#include <stdlib.h>

#define AHEAD 220  /* least distance from the lidar to what is ahead, in mm */
#define BESIDE 120 /* and to what is beside */

static int scan[360];

/* Smallest distance within some degrees of a direction: 0 ahead, 180 behind. */
static int nearest(int direction, int degrees)
{
    int angle, least = 9999;

    for (angle = direction - degrees; angle <= direction + degrees; angle++) {
        int distance = scan[(540 - angle) % 360];
        if (distance < least)
            least = distance;
    }
    return least;
}

/* Drives on, backwards if the speed is negative, or stops before something. Returns whether it drives. */
static int drive(int speed, int turn)
{
    int direction = speed < 0 ? 180 : 0, is_free;

    LIDARGet(scan);
    is_free = nearest(direction, 60) > AHEAD && nearest(direction, 100) > BESIDE;
    VWSetSpeed(is_free ? speed : 0, is_free ? turn : 0);
    return is_free;
}

/* Backs up, as far as there is room behind, and turns. */
static void back_up_and_turn(int angle)
{
    int until = OSGetCount() + 1000;

    while (OSGetCount() < until && drive(-100, 0))
        ;
    VWTurn(angle, 90);
    VWWait();
}

/* Milliseconds to drive: five minutes, or as many seconds as the command line says. */
static int duration(int argc, char **argv)
{
    return argc > 1 ? 1000 * atoi(argv[1]) : 300000;
}

/* To and fro. The turns alternate, so that what they are wrong by cancels out. */
static void left_right(int milliseconds)
{
    int side = 1;

    while (OSGetCount() < milliseconds)
        if (!drive(150, 0)) {
            back_up_and_turn(180 * side);
            side = -side;
        }
}

/* Up and down on the line on which it has started. */
static void middle_line(int milliseconds)
{
    int side = 1, x, y, phi, error, turn;

    while (OSGetCount() < milliseconds) {
        VWGetPosition(&x, &y, &phi);
        error = ((side > 0 ? phi : phi - 180) + 540) % 360 - 180;
        turn = -error - side * y / 5;
        if (!drive(150, turn > 30 ? 30 : turn < -30 ? -30 : turn)) {
            back_up_and_turn(180 * side);
            side = -side;
        }
    }
}

/* Straight on, and after each obstacle in any other direction. */
static void anywhere(int milliseconds)
{
    while (OSGetCount() < milliseconds)
        if (!drive(150, 0))
            back_up_and_turn(90 + rand() % 180);
}
