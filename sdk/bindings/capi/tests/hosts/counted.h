/* Counts the allocator calls and the allocated bytes of this program and its libraries. Without
 * COUNTED nothing is counted: valgrind and the sanitizers have their own allocator.
 */
#ifndef COUNTED_H
#define COUNTED_H

#include <stddef.h>

/* Calls of this thread while it is counting. */
static _Thread_local int counting;
static _Thread_local long calls;

#ifdef COUNTED
#include <errno.h>
#include <malloc.h>
#include <stdatomic.h>

static _Atomic long live_bytes;

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *old, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);
extern void __libc_free(void *old);

static void *counted(void *made)
{
    calls += counting;
    if (made != NULL)
        live_bytes += (long)malloc_usable_size(made);
    return made;
}

static void forget(void *old)
{
    calls += counting;
    if (old != NULL)
        live_bytes -= (long)malloc_usable_size(old);
}

void *malloc(size_t size)
{
    return counted(__libc_malloc(size));
}

void *calloc(size_t count, size_t size)
{
    return counted(__libc_calloc(count, size));
}

void *realloc(void *old, size_t size)
{
    forget(old);
    return counted(__libc_realloc(old, size));
}

void *memalign(size_t alignment, size_t size)
{
    return counted(__libc_memalign(alignment, size));
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return counted(__libc_memalign(alignment, size));
}

int posix_memalign(void **out, size_t alignment, size_t size)
{
    *out = counted(__libc_memalign(alignment, size));
    return *out == NULL ? ENOMEM : 0;
}

void free(void *old)
{
    forget(old);
    __libc_free(old);
}
#endif

#endif
