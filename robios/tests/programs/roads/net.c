/* A car that a trained network steers: it sees the road part of the grey image, and says the curvature. The
 * network is that of `roverlab end-to-end`, read from a file .safetensors: a header in JSON, then its numbers.
 */
#include "check.h"

#include <math.h>

#define SPEED 500 /* mm/s */
#define LONGEST 14000 /* ms */
#define PERIOD 33 /* ms */
#define TOP 64 /* rows of the image with road */
#define BOTTOM 223
#define LAYERS 8
#define VALUES 8192

struct layer {
    int filters, size, stride, taps;
    float *weights, *constants;
};

static struct layer layers[LAYERS];
static int count, rows, columns;
static BYTE image[QVGA_PIXELS];
static float maps[2][VALUES];

/* Where the numbers of a tensor begin. */
static char *tensor(char *head, char *data, int layer, const char *name)
{
    char key[40], *at;

    sprintf(key, "\"%d.%s\"", layer, name);
    CHECK((at = strstr(head, key)) && (at = strstr(at, "data_offsets")) && (at = strchr(at, '[')));
    return data + atol(at + 1);
}

static void load(const char *name)
{
    FILE *file = fopen(name, "rb");
    unsigned char size[8];
    char *head, *data, *word, text[256];
    long length, channels = 1, height, width, i, n;

    CHECK(file && fread(size, 1, 8, file) == 8);
    length = size[0] + 256L * size[1] + 65536L * size[2];
    CHECK(head = calloc(length + 1, 1));
    CHECK(fread(head, 1, length, file) == (size_t)length);
    CHECK(data = malloc(1 << 20));
    fread(data, 1, 1 << 20, file);
    fclose(file);
    CHECK((word = strstr(head, "architecture\":\"")) && sscanf(word + 15, "%255[^\"]", text) == 1);
    CHECK(sscanf(text, "%dx%d", &rows, &columns) == 2);
    height = rows;
    width = columns;
    strtok(text, " ");
    while ((word = strtok(NULL, " ")) && count < LAYERS) {
        struct layer *l = layers + count++;
        short *whole = (short *)tensor(head, data, count, "weights");
        float *units = (float *)tensor(head, data, count, "units");

        l->constants = (float *)tensor(head, data, count, "constants");
        if (sscanf(word, "conv%d/%d/%d", &l->filters, &l->size, &l->stride) == 3) {
            l->taps = l->size * l->size * channels;
            height = (height - l->size) / l->stride + 1;
            width = (width - l->size) / l->stride + 1;
        } else {
            CHECK(sscanf(word, "dense%d", &l->filters) == 1);
            l->taps = height * width * channels;
            height = width = 1;
        }
        channels = l->filters;
        CHECK(height * width * channels <= VALUES && (l->weights = malloc(l->filters * l->taps * sizeof(float))));
        for (i = 0; i < l->filters; i++)
            for (n = 0; n < l->taps; n++)
                l->weights[i * l->taps + n] = units[i] * whole[i * l->taps + n];
    }
    CHECK(count > 0 && layers[count - 1].filters == 1);
}

/* Means of the road part of the image, with mean 0 and deviation 1. */
static void see(float *values)
{
    int x, y, u, v, n = 0;
    double mean = 0, square = 0;

    for (y = 0; y < rows; y++)
        for (x = 0; x < columns; x++, n++) {
            int top = TOP + y * (BOTTOM - TOP) / rows, bottom = TOP + (y + 1) * (BOTTOM - TOP) / rows;
            int left = x * QVGA_X / columns, right = (x + 1) * QVGA_X / columns, sum = 0;

            for (v = top; v < bottom; v++)
                for (u = left; u < right; u++)
                    sum += image[v * QVGA_X + u];
            values[n] = (float)sum / ((bottom - top) * (right - left));
            mean += values[n];
        }
    mean /= n;
    for (x = 0; x < n; x++)
        square += (values[x] - mean) * (values[x] - mean);
    square = sqrt(square / n);
    for (x = 0; x < n; x++)
        values[x] = (values[x] - mean) / (square > 1 ? square : 1);
}

/* The result of the network. */
static float run(void)
{
    int height = rows, width = columns, channels = 1, i, x, y, f, n;

    for (i = 0; i < count; i++) {
        struct layer *l = layers + i;
        float *from = maps[i % 2], *to = maps[1 - i % 2];
        int size = l->size ? l->size : 1, row = l->size ? size * channels : l->taps;
        int high = l->size ? (height - size) / l->stride + 1 : 1, wide = l->size ? (width - size) / l->stride + 1 : 1;

        for (y = 0; y < high; y++)
            for (x = 0; x < wide; x++)
                for (f = 0; f < l->filters; f++) {
                    float sum = l->constants[f], *weight = l->weights + f * l->taps;

                    for (n = 0; n < l->taps; n++)
                        sum += weight[n] * from[((y * l->stride + n / row) * width + x * l->stride) * channels + n % row];
                    to[(y * wide + x) * l->filters + f] = i < count - 1 && sum < 0 ? 0 : sum;
                }
        height = high;
        width = wide;
        channels = l->filters;
    }
    return maps[count % 2][0];
}

int main(void)
{
    load("steering.safetensors");
    CAMInit(QVGA);
    while (OSGetCount() < LONGEST) {
        float part;

        CAMGetGray(image);
        see(maps[0]);
        part = run();
        part = part > 1 ? 1 : part < -1 ? -1 : part;
        VWSetSpeed(SPEED, (int)lround(SPEED / 1000.0 * 2 * part * 57.3));
        OSWait(PERIOD);
    }
    return VWSetSpeed(0, 0);
}
