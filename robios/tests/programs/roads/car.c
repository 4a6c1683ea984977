/* A car that keeps in its lane by the line on its right, tells where it is, and obeys the base station: it stops,
 * goes on, and ends its program when that says so, or after two minutes.
 *
 * It begins in the middle of its lane. Rows of the image are places on the floor ahead: the camera is HEIGHT
 * above it, looks level, and sees PIXELS pixels per radian in its middle.
 */
#include "check.h"

#define HEIGHT 60 /* mm */
#define PIXELS 277
#define ROWS 3
#define SPEED 150 /* mm/s */
#define BRIGHT 60 /* more than the floor, in grey levels */
#define PERIOD 200 /* of reports, in ms */
#define LONGEST 120000

static BYTE image[QVGA_PIXELS];
static const int rows[ROWS] = {155, 170, 185};
static int middle[ROWS]; /* mm from the lane's middle to the line */
static int station; /* number of the base station, once it has been heard */

/* Distance on the floor to the first line to the right of the middle, in mm; -1 without one. */
static int line_in(int row)
{
    BYTE *pixels = image + row * QVGA_X;
    int x, ahead = HEIGHT * PIXELS / (row - QVGA_Y / 2);

    for (x = QVGA_X / 2; x < QVGA_X - 2; x++)
        if (pixels[x] > pixels[QVGA_X / 2] + BRIGHT && pixels[x + 1] > pixels[QVGA_X / 2] + BRIGHT)
            return (x - QVGA_X / 2) * ahead / PIXELS;
    return -1;
}

/* Tells the base station where the car is. */
static void report(int stands)
{
    char text[80];
    int x, y, phi;

    VWGetPosition(&x, &y, &phi);
    sprintf(text, "car %.3f %.3f %.2f %.2f 0 own %s", x / 1000.0, y / 1000.0, phi * 3.14159 / 180,
            stands ? 0 : SPEED / 1000.0, stands ? "stand" : "drive");
    RADIOSend(station, text);
}

/* The last order of the base station: 's' for stop, 'g' for go, 'e' for the end. */
static char hear(char order)
{
    char text[80];
    int from;

    while (RADIOCheck()) {
        RADIOReceive(&from, text, sizeof text);
        station = from;
        order = text[0];
    }
    return order;
}

int main(void)
{
    int due = 0, turn = 0, i;
    char order = 'g';

    CAMInit(QVGA);
    RADIOInit();
    CAMGetGray(image);
    for (i = 0; i < ROWS; i++)
        CHECK((middle[i] = line_in(rows[i])) > 0);
    while ((order = hear(order)) != 'e' && OSGetCount() < LONGEST) {
        int off = 0, seen = 0, stopped = order == 's';

        CAMGetGray(image);
        for (i = 0; i < ROWS; i++) {
            int line = line_in(rows[i]);

            if (line >= 0 && abs(line - middle[i]) < middle[i])
                off += line - middle[i], seen++;
        }
        /* An arc to a place 340 mm ahead, as far beside the car as the lane's middle is; without a line, the
         * same arc as before. */
        if (seen)
            turn = -off / seen * 2 * SPEED * 57 / (340 * 340);
        VWSetSpeed(stopped ? 0 : SPEED, stopped ? 0 : turn);
        if (station && OSGetCount() >= due) {
            report(stopped);
            due = OSGetCount() + PERIOD;
        }
        OSWait(30);
    }
    RADIORelease();
    return VWSetSpeed(0, 0);
}
