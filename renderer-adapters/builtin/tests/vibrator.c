/* An application with a vibrator that plays envelopes, which holds the device to what Android's documentation of
 * `VibrationEffect.WaveformEnvelopeBuilder`, `VibratorEnvelopeEffectInfo` and `VibratorFrequencyProfile` (API 36) says, and records the effects. */
#define _GNU_SOURCE
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The declarations that docs/devices.md gives to applications. */
#include "pwle.h"

/* The documentation guarantees 16 points, a shortest point of at most 20 ms and a longest one of at least 1 s. */
static htex_pwle_limits_t limits = {16, 20, 1000, 60, 300};
static int absent, fails;
static char text[1 << 20];
static size_t length;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static int32_t broken(const char *rule) {
    length += (size_t)snprintf(text + length, sizeof text - length, "broken %s\n", rule);
    return -2;
}

int32_t htex_pwle_limits(htex_pwle_limits_t *out) {
    *out = limits;
    return absent ? -1 : 0;
}

static int32_t rule(const htex_pwle_point_t *points, uint32_t count) {
    if (points == NULL || count == 0) return broken("no-points"); /* build(): at least one control point */
    if (count > limits.most_points) return broken("most-points"); /* getMaxSize() */
    for (uint32_t i = 0; i < count; i++) {
        if (!(points[i].amplitude >= 0 && points[i].amplitude <= 1)) return broken("amplitude-0-to-1"); /* addControlPoint(): amplitude */
        if (!(points[i].frequency_hz > 0)) return broken("frequency-above-0"); /* addControlPoint(): frequencyHz */
        if (points[i].frequency_hz < limits.low_hz || points[i].frequency_hz > limits.high_hz) return broken("frequency-in-profile");
        if (points[i].duration_ms < limits.least_ms || points[i].duration_ms > limits.most_ms) return broken("duration"); /* get{Min,Max}ControlPointDurationMillis() */
    }
    return 0;
}

int32_t htex_pwle_play(const htex_pwle_point_t *points, uint32_t count) {
    pthread_mutex_lock(&lock);
    int32_t code = fails ? -5 : rule(points, count);
    if (code == 0) {
        length += (size_t)snprintf(text + length, sizeof text - length, "effect");
        for (uint32_t i = 0; i < count; i++)
            length += (size_t)snprintf(text + length, sizeof text - length, " %.4f:%.2f:%u", points[i].amplitude, points[i].frequency_hz, points[i].duration_ms);
        length += (size_t)snprintf(text + length, sizeof text - length, "\n");
    }
    pthread_mutex_unlock(&lock);
    return code;
}

int32_t htex_pwle_cancel(void) {
    pthread_mutex_lock(&lock);
    length += (size_t)snprintf(text + length, sizeof text - length, "cancel\n");
    pthread_mutex_unlock(&lock);
    return 0;
}

int mock_set(const char *name, double value) {
    if (strcmp(name, "fails") == 0) fails = value != 0;
    else if (strcmp(name, "absent") == 0) absent = value != 0;
    else if (strcmp(name, "most_points") == 0) limits.most_points = (uint32_t)value;
    else return 0;
    return 1;
}

const char *mock_record(void) {
    static char *given;
    pthread_mutex_lock(&lock);
    free(given);
    given = strndup(text, length);
    length = 0;
    pthread_mutex_unlock(&lock);
    return given;
}
