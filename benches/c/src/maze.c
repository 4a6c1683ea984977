/* Flood fill of mazes in C: the sweep over all cells that the book describes in section 9.6, and a queue. */

#include <stdint.h>
#include <string.h>

#define SIDE 16
#define CELLS (SIDE * SIDE)

/* Walls of the sweep: below and to the left of each cell, one row and column more than there are cells. */
struct walls {
    int32_t below[SIDE + 1][SIDE + 1];
    int32_t left[SIDE + 1][SIDE + 1];
};

/* Passes over the whole maze until the goal has a number, or as many times as there are cells: every cell without a
 * number that has a numbered neighbour takes that number plus one, in a second map, so that a pass takes one step. */
void roverlab_sweep(const struct walls *walls, int32_t start, int32_t goal, int32_t *steps)
{
    int32_t map[SIDE][SIDE], next[SIDE][SIDE];
    int pass = 0;
    memset(map, -1, sizeof map);
    map[start / SIDE][start % SIDE] = 0;
    memcpy(next, map, sizeof next);
    while (map[goal / SIDE][goal % SIDE] < 0 && pass++ < CELLS) {
        for (int row = 0; row < SIDE; row++) {
            for (int column = 0; column < SIDE; column++) {
                if (map[row][column] >= 0)
                    continue;
                if (row > 0 && !walls->below[row][column] && map[row - 1][column] >= 0)
                    next[row][column] = map[row - 1][column] + 1;
                if (row < SIDE - 1 && !walls->below[row + 1][column] && map[row + 1][column] >= 0)
                    next[row][column] = map[row + 1][column] + 1;
                if (column > 0 && !walls->left[row][column] && map[row][column - 1] >= 0)
                    next[row][column] = map[row][column - 1] + 1;
                if (column < SIDE - 1 && !walls->left[row][column + 1] && map[row][column + 1] >= 0)
                    next[row][column] = map[row][column + 1] + 1;
            }
        }
        for (int row = 0; row < SIDE; row++)
            for (int column = 0; column < SIDE; column++)
                map[row][column] = next[row][column];
    }
    memcpy(steps, map, sizeof map);
}

/* Breadth-first search over the whole maze with a queue of cells; `open` has a bit for each direction, north in the
 * lowest, clockwise. Cells that nothing reaches are -1. */
void roverlab_queue(const uint8_t *open, int32_t start, int32_t *steps)
{
    static const int offsets[4] = {SIDE, 1, -SIDE, -1};
    uint8_t queue[CELLS];
    int head = 0, tail = 0;
    memset(steps, -1, CELLS * sizeof *steps);
    steps[start] = 0;
    queue[tail++] = (uint8_t)start;
    while (head < tail) {
        int here = queue[head++];
        for (int side = 0; side < 4; side++) {
            int there = here + offsets[side];
            if ((open[here] >> side & 1) && steps[there] < 0) {
                steps[there] = steps[here] + 1;
                queue[tail++] = (uint8_t)there;
            }
        }
    }
}
