/* What the plugin for FMOD uses of FMOD's header of this name, written as fmod_common.h here: the layouts of version 110 of the plugin SDK.
 * Functions that neither the plugin nor its host calls are pointers to any function; parts of unions that are not used keep their size.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef HTEX_STUB_FMOD_DSP_H
#define HTEX_STUB_FMOD_DSP_H

#include "fmod_common.h"

#define FMOD_PLUGIN_SDK_VERSION 110
#define FMOD_DSP_GETPARAM_VALUESTR_LENGTH 32

typedef struct FMOD_DSP_STATE FMOD_DSP_STATE;
typedef void(F_CALL *HTEX_STUB_UNUSED)(void);

typedef enum { FMOD_DSP_PROCESS_PERFORM = 0, FMOD_DSP_PROCESS_QUERY = 1 } FMOD_DSP_PROCESS_OPERATION;

typedef enum FMOD_DSP_PARAMETER_TYPE {
    FMOD_DSP_PARAMETER_TYPE_FLOAT = 0,
    FMOD_DSP_PARAMETER_TYPE_INT = 1,
    FMOD_DSP_PARAMETER_TYPE_BOOL = 2,
    FMOD_DSP_PARAMETER_TYPE_DATA = 3,
    FMOD_DSP_PARAMETER_TYPE_FORCEINT = 65536
} FMOD_DSP_PARAMETER_TYPE;

typedef enum FMOD_DSP_PARAMETER_FLOAT_MAPPING_TYPE {
    FMOD_DSP_PARAMETER_FLOAT_MAPPING_TYPE_LINEAR = 0,
    FMOD_DSP_PARAMETER_FLOAT_MAPPING_TYPE_AUTO = 1,
    FMOD_DSP_PARAMETER_FLOAT_MAPPING_TYPE_FORCEINT = 65536
} FMOD_DSP_PARAMETER_FLOAT_MAPPING_TYPE;

typedef enum FMOD_DSP_PARAMETER_DATA_TYPE { FMOD_DSP_PARAMETER_DATA_TYPE_USER = 0 } FMOD_DSP_PARAMETER_DATA_TYPE;

typedef struct FMOD_DSP_BUFFER_ARRAY {
    int numbuffers;
    int *buffernumchannels;
    FMOD_CHANNELMASK *bufferchannelmask;
    float **buffers;
    FMOD_SPEAKERMODE speakermode;
} FMOD_DSP_BUFFER_ARRAY;

typedef FMOD_RESULT(F_CALL *FMOD_DSP_CREATE_CALLBACK)(FMOD_DSP_STATE *dsp_state);
typedef FMOD_RESULT(F_CALL *FMOD_DSP_RELEASE_CALLBACK)(FMOD_DSP_STATE *dsp_state);
typedef FMOD_RESULT(F_CALL *FMOD_DSP_RESET_CALLBACK)(FMOD_DSP_STATE *dsp_state);
typedef FMOD_RESULT(F_CALL *FMOD_DSP_PROCESS_CALLBACK)(FMOD_DSP_STATE *dsp_state, unsigned int length,
                                                       const FMOD_DSP_BUFFER_ARRAY *inbufferarray,
                                                       FMOD_DSP_BUFFER_ARRAY *outbufferarray, FMOD_BOOL inputsidle,
                                                       FMOD_DSP_PROCESS_OPERATION op);
typedef FMOD_RESULT(F_CALL *FMOD_DSP_SHOULDIPROCESS_CALLBACK)(FMOD_DSP_STATE *dsp_state, FMOD_BOOL inputsidle,
                                                              unsigned int length, FMOD_CHANNELMASK inmask, int inchannels,
                                                              FMOD_SPEAKERMODE speakermode);
typedef FMOD_RESULT(F_CALL *FMOD_DSP_SETPARAM_FLOAT_CALLBACK)(FMOD_DSP_STATE *dsp_state, int index, float value);
typedef FMOD_RESULT(F_CALL *FMOD_DSP_SETPARAM_INT_CALLBACK)(FMOD_DSP_STATE *dsp_state, int index, int value);
typedef FMOD_RESULT(F_CALL *FMOD_DSP_SETPARAM_DATA_CALLBACK)(FMOD_DSP_STATE *dsp_state, int index, void *data,
                                                             unsigned int length);
typedef FMOD_RESULT(F_CALL *FMOD_DSP_GETPARAM_FLOAT_CALLBACK)(FMOD_DSP_STATE *dsp_state, int index, float *value,
                                                              char *valuestr);
typedef FMOD_RESULT(F_CALL *FMOD_DSP_GETPARAM_INT_CALLBACK)(FMOD_DSP_STATE *dsp_state, int index, int *value,
                                                            char *valuestr);
typedef FMOD_RESULT(F_CALL *FMOD_DSP_GETPARAM_DATA_CALLBACK)(FMOD_DSP_STATE *dsp_state, int index, void **data,
                                                             unsigned int *length, char *valuestr);

typedef void *(F_CALL *FMOD_DSP_ALLOC_FUNC)(unsigned int size, FMOD_MEMORY_TYPE type, const char *sourcestr);
typedef void *(F_CALL *FMOD_DSP_REALLOC_FUNC)(void *ptr, unsigned int size, FMOD_MEMORY_TYPE type, const char *sourcestr);
typedef void(F_CALL *FMOD_DSP_FREE_FUNC)(void *ptr, FMOD_MEMORY_TYPE type, const char *sourcestr);
typedef void(F_CALL *FMOD_DSP_LOG_FUNC)(FMOD_DEBUG_FLAGS level, const char *file, int line, const char *function,
                                        const char *str, ...);
typedef FMOD_RESULT(F_CALL *FMOD_DSP_GETSAMPLERATE_FUNC)(FMOD_DSP_STATE *dsp_state, int *rate);

typedef struct FMOD_DSP_PARAMETER_FLOAT_MAPPING_PIECEWISE_LINEAR {
    int numpoints;
    float *pointparamvalues;
    float *pointpositions;
} FMOD_DSP_PARAMETER_FLOAT_MAPPING_PIECEWISE_LINEAR;

typedef struct FMOD_DSP_PARAMETER_FLOAT_MAPPING {
    FMOD_DSP_PARAMETER_FLOAT_MAPPING_TYPE type;
    FMOD_DSP_PARAMETER_FLOAT_MAPPING_PIECEWISE_LINEAR piecewiselinearmapping;
} FMOD_DSP_PARAMETER_FLOAT_MAPPING;

typedef struct FMOD_DSP_PARAMETER_DESC_FLOAT {
    float min;
    float max;
    float defaultval;
    FMOD_DSP_PARAMETER_FLOAT_MAPPING mapping;
} FMOD_DSP_PARAMETER_DESC_FLOAT;

typedef struct FMOD_DSP_PARAMETER_DESC_INT {
    int min;
    int max;
    int defaultval;
    FMOD_BOOL goestoinf;
    const char *const *valuenames;
} FMOD_DSP_PARAMETER_DESC_INT;

typedef struct FMOD_DSP_PARAMETER_DESC_DATA {
    int datatype;
} FMOD_DSP_PARAMETER_DESC_DATA;

typedef struct FMOD_DSP_PARAMETER_DESC {
    FMOD_DSP_PARAMETER_TYPE type;
    char name[16];
    char label[16];
    const char *description;
    union {
        FMOD_DSP_PARAMETER_DESC_FLOAT floatdesc;
        FMOD_DSP_PARAMETER_DESC_INT intdesc;
        FMOD_DSP_PARAMETER_DESC_DATA datadesc;
    };
} FMOD_DSP_PARAMETER_DESC;

typedef struct FMOD_DSP_DESCRIPTION {
    unsigned int pluginsdkversion;
    char name[32];
    unsigned int version;
    int numinputbuffers;
    int numoutputbuffers;
    FMOD_DSP_CREATE_CALLBACK create;
    FMOD_DSP_RELEASE_CALLBACK release;
    FMOD_DSP_RESET_CALLBACK reset;
    HTEX_STUB_UNUSED read;
    FMOD_DSP_PROCESS_CALLBACK process;
    HTEX_STUB_UNUSED setposition;
    int numparameters;
    FMOD_DSP_PARAMETER_DESC **paramdesc;
    FMOD_DSP_SETPARAM_FLOAT_CALLBACK setparameterfloat;
    FMOD_DSP_SETPARAM_INT_CALLBACK setparameterint;
    HTEX_STUB_UNUSED setparameterbool;
    FMOD_DSP_SETPARAM_DATA_CALLBACK setparameterdata;
    FMOD_DSP_GETPARAM_FLOAT_CALLBACK getparameterfloat;
    FMOD_DSP_GETPARAM_INT_CALLBACK getparameterint;
    HTEX_STUB_UNUSED getparameterbool;
    FMOD_DSP_GETPARAM_DATA_CALLBACK getparameterdata;
    FMOD_DSP_SHOULDIPROCESS_CALLBACK shouldiprocess;
    void *userdata;
    HTEX_STUB_UNUSED sys_register;
    HTEX_STUB_UNUSED sys_deregister;
    HTEX_STUB_UNUSED sys_mix;
} FMOD_DSP_DESCRIPTION;

typedef struct FMOD_DSP_STATE_FUNCTIONS {
    FMOD_DSP_ALLOC_FUNC alloc;
    FMOD_DSP_REALLOC_FUNC realloc;
    FMOD_DSP_FREE_FUNC free;
    FMOD_DSP_GETSAMPLERATE_FUNC getsamplerate;
    HTEX_STUB_UNUSED getblocksize;
    void *dft;
    void *pan;
    HTEX_STUB_UNUSED getspeakermode;
    HTEX_STUB_UNUSED getclock;
    HTEX_STUB_UNUSED getlistenerattributes;
    FMOD_DSP_LOG_FUNC log;
    HTEX_STUB_UNUSED getuserdata;
} FMOD_DSP_STATE_FUNCTIONS;

struct FMOD_DSP_STATE {
    void *instance;
    void *plugindata;
    FMOD_CHANNELMASK channelmask;
    FMOD_SPEAKERMODE source_speakermode;
    float *sidechaindata;
    int sidechainchannels;
    FMOD_DSP_STATE_FUNCTIONS *functions;
    int systemobject;
};

#define FMOD_DSP_ALLOC(_state, _size) (_state)->functions->alloc(_size, FMOD_MEMORY_NORMAL, __FILE__)
#define FMOD_DSP_FREE(_state, _ptr) (_state)->functions->free(_ptr, FMOD_MEMORY_NORMAL, __FILE__)
#define FMOD_DSP_LOG(_state, _level, _location, _format, ...)                                                          \
    (_state)->functions->log(_level, __FILE__, __LINE__, _location, _format, __VA_ARGS__)
#define FMOD_DSP_GETSAMPLERATE(_state, _rate) (_state)->functions->getsamplerate(_state, _rate)

#endif
