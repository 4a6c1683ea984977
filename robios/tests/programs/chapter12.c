/* Numbers that get better by selection, crossover and mutation: the speeds of two wheels that bring the robot farthest. */
#include "check.h"

#define POPULATION 6
#define GENERATIONS 4

typedef struct {
    BYTE gene[2];
    int fitness;
} Individual;

static int tried(const Individual *one)
{
    int x, y, z, phi;

    SIMSetRobot(0, 2000, 2000, 0, 90);
    VWSetPosition(0, 0, 0);
    SERVOSet(1, one->gene[0]);
    MOTORDrive(1, one->gene[0] - 128);
    MOTORDrive(2, one->gene[1] - 128);
    OSWait(1500);
    MOTORDrive(1, 0), MOTORDrive(2, 0);
    OSWait(500);
    SIMGetRobot(0, &x, &y, &z, &phi);
    return 1 + (int)hypot(x - 2000, y - 2000);
}

static int chosen(const Individual *all, int sum)
{
    int i = 0, wheel = rand() % sum;

    while (wheel >= all[i].fitness)
        wheel -= all[i++].fitness;
    return i;
}

int main(void)
{
    Individual all[POPULATION], next[POPULATION];
    int generation, i, best = 0, first = 0;

    srand(1);
    for (i = 0; i < POPULATION; i++)
        all[i].gene[0] = 118 + rand() % 20, all[i].gene[1] = 118 + rand() % 20;
    for (generation = 0; generation < GENERATIONS; generation++) {
        int sum = 0;
        for (i = best = 0; i < POPULATION; i++) {
            sum += all[i].fitness = tried(&all[i]);
            if (all[i].fitness > all[best].fitness)
                best = i;
        }
        if (generation == 0)
            first = all[best].fitness;
        CHECK(all[best].fitness >= first * 9 / 10);
        LCDPrintf("generation %d: %d mm\n", generation, all[best].fitness);
        next[0] = all[best];
        for (i = 1; i < POPULATION; i++) {
            next[i].gene[0] = all[chosen(all, sum)].gene[0];
            next[i].gene[1] = all[chosen(all, sum)].gene[1];
            next[i].gene[rand() % 2] ^= 1 << rand() % 8;
        }
        memcpy(all, next, sizeof all);
    }
    return 0;
}
