/* The names, values and calling convention that the FMOD plugin uses from FMOD's header of this
 * name. They were written from FMOD's published documentation (FMOD Engine User Manual 2.02 and
 * 2.03, "Core API Reference" and "Plug-in API Reference, DSP"). This is not FMOD's header and does
 * not replace it: build plugins with the headers of the FMOD Engine.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef HTEX_STUB_FMOD_COMMON_H
#define HTEX_STUB_FMOD_COMMON_H

#if defined(_WIN32)
#define F_CALL __stdcall
#define F_EXPORT __declspec(dllexport)
#else
#define F_CALL
#define F_EXPORT __attribute__((visibility("default")))
#endif

typedef int FMOD_BOOL;
typedef unsigned int FMOD_CHANNELMASK;
typedef unsigned int FMOD_DEBUG_FLAGS;
typedef unsigned int FMOD_MEMORY_TYPE;

#define FMOD_DEBUG_LEVEL_ERROR 0x00000001
#define FMOD_MEMORY_NORMAL 0x00000000

typedef enum FMOD_RESULT {
    FMOD_OK = 0,
    FMOD_ERR_DSP_SILENCE = 11,
    FMOD_ERR_FORMAT = 19,
    FMOD_ERR_INVALID_FLOAT = 29,
    FMOD_ERR_INVALID_PARAM = 31,
    FMOD_ERR_MEMORY = 38,
    FMOD_ERR_PLUGIN = 53,
    FMOD_RESULT_FORCEINT = 65536
} FMOD_RESULT;

typedef enum FMOD_SPEAKERMODE {
    FMOD_SPEAKERMODE_DEFAULT = 0,
    FMOD_SPEAKERMODE_MONO = 2,
    FMOD_SPEAKERMODE_STEREO = 3,
    FMOD_SPEAKERMODE_FORCEINT = 65536
} FMOD_SPEAKERMODE;

/* Like FMOD's header, this one includes the header for plugins. */
#include "fmod_dsp.h"

#endif
