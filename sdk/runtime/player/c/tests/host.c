/* Plays cases from the file that is the first argument, and writes the results to the file that is
   the second. Each block is copied to its own memory, so that a sanitizer detects a read beyond
   it. */
#include <stdio.h>
#include <stdlib.h>

#include "cases.h"

static FILE *results;

void *memory_of(size_t size)
{
    return malloc(size);
}

void release(void *memory)
{
    free(memory);
}

void put(const void *bytes, size_t length)
{
    fwrite(bytes, 1, length, results);
}

static uint8_t *read_all(const char *name, size_t *length)
{
    FILE *file = fopen(name, "rb");
    if (!file || fseek(file, 0, SEEK_END) != 0) {
        return 0;
    }
    *length = (size_t)ftell(file);
    rewind(file);
    uint8_t *bytes = malloc(*length);
    if (bytes && fread(bytes, 1, *length, file) != *length) {
        *length = 0;
    }
    fclose(file);
    return bytes;
}

int main(int count, char **arguments)
{
    size_t length = 0;
    uint8_t *cases = count == 3 ? read_all(arguments[1], &length) : 0;
    results = count == 3 ? fopen(arguments[2], "wb") : 0;
    if (!cases || !results) {
        return 2;
    }
    int wrong = play_cases(cases, length);
    free(cases);
    if (wrong || fclose(results) != 0) {
        printf("cases.c, line %d\n", wrong);
        return 1;
    }
    return 0;
}
