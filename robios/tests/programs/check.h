/* Programs of tests say on standard error what is wrong, and end with status 1. */
#include "eyebot.h"

#define CHECK(condition) \
    do { \
        if (!(condition)) { \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition); \
            exit(1); \
        } \
    } while (0)
#define NEAR(value, expected, most) CHECK(abs((value) - (expected)) <= (most))
