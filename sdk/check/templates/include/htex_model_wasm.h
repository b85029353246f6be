/* htex_model_wasm.h: what a model in C needs as a WASM module without a C library: room for what the
 * host passes (htex_model_alloc, htex_model_free), and the two functions to which compilers turn
 * copies. Include it in one file of the model. In a native library it is empty.
 *
 * Not part of the ABI: a model may bring its own.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef HTEX_MODEL_WASM_H
#define HTEX_MODEL_WASM_H

#include "htex_model.h"

#if defined(__wasm__)

void *memcpy(void *restrict to, const void *restrict from, size_t len)
{
    for (size_t i = 0; i < len; i++)
        ((volatile uint8_t *)to)[i] = ((const uint8_t *)from)[i];
    return to;
}

void *memset(void *to, int value, size_t len)
{
    for (size_t i = 0; i < len; i++)
        ((volatile uint8_t *)to)[i] = (uint8_t)value;
    return to;
}

/* Where the linker's data end. */
extern uint8_t __heap_base;
/* Rooms come in powers of two; those given back wait in a list for each size. */
static uint8_t *htex_rooms[31];
static size_t htex_heap_end;

static int htex_size_class(size_t len)
{
    int size_class = 4;
    while (size_class < 31 && ((size_t)1 << size_class) < len)
        size_class++;
    return size_class;
}

uint8_t *htex_model_alloc(size_t len)
{
    int size_class = htex_size_class(len);
    if (len == 0 || size_class == 31)
        return NULL;
    uint8_t *room = htex_rooms[size_class];
    if (room != NULL) {
        htex_rooms[size_class] = *(uint8_t **)(void *)room;
    } else {
        if (htex_heap_end == 0)
            htex_heap_end = ((size_t)&__heap_base + 15) & ~(size_t)15;
        size_t end = htex_heap_end + ((size_t)1 << size_class);
        size_t pages = (end + 65535) / 65536, have = __builtin_wasm_memory_size(0);
        if (end < htex_heap_end
            || (pages > have && __builtin_wasm_memory_grow(0, pages - have) == (size_t)-1))
            return NULL;
        room = (uint8_t *)htex_heap_end;
        htex_heap_end = end;
    }
    return memset(room, 0, len);
}

void htex_model_free(uint8_t *pointer, size_t len)
{
    if (pointer == NULL || len == 0)
        return;
    int size_class = htex_size_class(len);
    *(uint8_t **)(void *)pointer = htex_rooms[size_class];
    htex_rooms[size_class] = pointer;
}

#endif
#endif
