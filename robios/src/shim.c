/* What stable Rust cannot do: functions with arguments like printf, and a function that runs when the library is loaded.
 * Texts are formatted here and handed over as they are then. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void eyesim_begin(void);
void eyesim_end(void);
int eyesim_print(const char *text);
int eyesim_print_at(int row, int column, const char *text);
int eyesim_shim_printf(const char *format, ...);
int eyesim_shim_set_printf(int row, int column, const char *format, ...);

__attribute__((constructor)) static void begin(void)
{
    eyesim_begin();
    atexit(eyesim_end);
}

/* No display shows more at once, and no program needs it. */
#define LONGEST 65536

static char *formatted(const char *format, va_list arguments, char *brief, size_t room)
{
    va_list again;
    char *text;
    int length;

    va_copy(again, arguments);
    length = vsnprintf(brief, room, format, again);
    va_end(again);
    if (length < 0)
        return NULL;
    if ((size_t)length < room)
        return brief;
    if (length >= LONGEST)
        length = LONGEST - 1;
    text = malloc((size_t)length + 1);
    if (text != NULL)
        vsnprintf(text, (size_t)length + 1, format, arguments);
    return text;
}

int eyesim_shim_printf(const char *format, ...)
{
    char brief[512];
    va_list arguments;
    char *text;
    int result;

    if (format == NULL)
        return 1;
    va_start(arguments, format);
    text = formatted(format, arguments, brief, sizeof brief);
    va_end(arguments);
    result = text != NULL ? eyesim_print(text) : 1;
    if (text != brief)
        free(text);
    return result;
}

int eyesim_shim_set_printf(int row, int column, const char *format, ...)
{
    char brief[512];
    va_list arguments;
    char *text;
    int result;

    if (format == NULL)
        return 1;
    va_start(arguments, format);
    text = formatted(format, arguments, brief, sizeof brief);
    va_end(arguments);
    result = text != NULL ? eyesim_print_at(row, column, text) : 1;
    if (text != brief)
        free(text);
    return result;
}
