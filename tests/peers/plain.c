/* Plain loops in C for one voice, with which cargo xtask bench compares.
 *
 * Speaks the protocol of tests/bench/src/peer.rs: a task's name a line comes in, "seconds units" goes out.
 * Arguments: order and coefficients of the all-pole filter, as text.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SAMPLES = 1 << 20, BLOCK = 256, VOICES = 1000, ROUNDS = 16, MOST = 64, SECTIONS = 2, LINES = 10, LANES = 8 };

/* Noise of its own, of which compilers make vector instructions: the sum of four uniform numbers of 16
 * bits. Its tails end at 3.5 sigma; it is quicker than a true normal law, and flatters C. */
typedef struct { uint64_t s[LANES]; } Noise;

static void noise_start(Noise *n, uint64_t seed) {
    for (int i = 0; i < LANES; i++) n->s[i] = (seed + 1) * 0x9E3779B97F4A7C15u + (uint64_t)i * 0xD1B54A32D192ED03u;
}

static void noise_fill(Noise *n, double *out, int len) {
    for (int k = 0; k + LANES <= len; k += LANES)
        for (int i = 0; i < LANES; i++) {
            uint64_t x = n->s[i];
            x ^= x << 13; x ^= x >> 7; x ^= x << 17;
            n->s[i] = x;
            int32_t sum = (int32_t)(x & 0xFFFF) + (int32_t)(x >> 16 & 0xFFFF) + (int32_t)(x >> 32 & 0xFFFF) + (int32_t)(x >> 48);
            out[k + i] = (sum - 131070) * (1.0 / 37837.0);
        }
}

static int order;
static double a[MOST];

typedef struct { Noise noise; double past[MOST]; double s1[SECTIONS], s2[SECTIONS]; } Voice;

static Voice voices[VOICES];
static float out[SAMPLES];

/* The all-pole filter, direct form; the newest output comes last, so that all else is ready when it is. */
static void all_pole(Voice *v, double *x, int len) {
    double y[MOST + BLOCK];
    memcpy(y, v->past, sizeof v->past);
    for (int n = 0; n < len; n++) {
        double sum = x[n];
        for (int i = order - 1; i >= 0; i--) sum += a[i] * y[MOST + n - 1 - i];
        y[MOST + n] = sum;
    }
    memcpy(x, y + MOST, (size_t)len * sizeof *x);
    memcpy(v->past, y + len, sizeof v->past);
}

/* Two sections one after the other, transposed direct form II: the Chebyshev high-pass of order 4 at
 * 17.5 Hz for 2 kHz, as our voice has it, and the same work as a band-pass of sSlope. */
static const double SOS[SECTIONS][5] = {
    {0.909822, -1.819644, 0.909822, -1.861370, 0.869042}, {1, -2, 1, -1.973117, 0.976448},
};

static void sections(Voice *v, double *x, int len) {
    for (int s = 0; s < SECTIONS; s++) {
        double s1 = v->s1[s], s2 = v->s2[s];
        for (int n = 0; n < len; n++) {
            double y = SOS[s][0] * x[n] + s1;
            s1 = SOS[s][1] * x[n] - SOS[s][3] * y + s2;
            s2 = SOS[s][2] * x[n] - SOS[s][4] * y;
            x[n] = y;
        }
        v->s1[s] = s1;
        v->s2[s] = s2;
    }
}

static void ar_block(Voice *v, float *to, int edges) {
    double block[BLOCK];
    noise_fill(&v->noise, block, BLOCK);
    all_pole(v, block, BLOCK);
    if (edges) sections(v, block, BLOCK);
    for (int n = 0; n < BLOCK; n++) to[n] = (float)block[n];
}

static void ar(int edges) {
    for (int k = 0; k < SAMPLES; k += BLOCK) ar_block(&voices[0], out + k, edges);
}

static void ar_many(int edges) {
    for (int k = 0; k < ROUNDS; k++)
        for (int v = 0; v < VOICES; v++) ar_block(&voices[v], out, edges);
}

static void slope(void) {
    Voice *v = &voices[0];
    for (int k = 0; k < SAMPLES; k += BLOCK) {
        double block[BLOCK];
        noise_fill(&v->noise, block, BLOCK);
        sections(v, block, BLOCK);
        for (int n = 0; n < BLOCK; n++) out[k + n] = (float)block[n];
    }
}

/* Ten sinusoids by rotation. */
static void lines(void) {
    static double re[LINES], im[LINES], c[LINES], s[LINES];
    for (int i = 0; i < LINES; i++) {
        double w = 2 * M_PI * (50 + 95 * i) / 20000;
        re[i] = 1; im[i] = 0; c[i] = cos(w); s[i] = sin(w);
    }
    for (int n = 0; n < SAMPLES; n++) {
        double sum = 0;
        for (int i = 0; i < LINES; i++) {
            double r = re[i] * c[i] - im[i] * s[i];
            im[i] = re[i] * s[i] + im[i] * c[i];
            re[i] = r;
            sum += r;
        }
        out[n] = (float)sum;
    }
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

int main(int argc, char **argv) {
    order = argc > 1 ? atoi(argv[1]) : 0;
    if (order < 1 || order > MOST || argc < 2 + order) return 2;
    for (int i = 0; i < order; i++) a[i] = atof(argv[2 + i]);
    for (int v = 0; v < VOICES; v++) noise_start(&voices[v].noise, (uint64_t)v);
    puts("ready ar ar_edges ar_many ar_many_edges sslope speak");
    fflush(stdout);
    char task[64];
    while (scanf("%63s", task) == 1) {
        double units = SAMPLES, begun = now();
        if (!strcmp(task, "ar")) ar(0);
        else if (!strcmp(task, "ar_edges")) ar(1);
        else if (!strcmp(task, "ar_many")) { ar_many(0); units = 1.0 * ROUNDS * VOICES * BLOCK; }
        else if (!strcmp(task, "ar_many_edges")) { ar_many(1); units = 1.0 * ROUNDS * VOICES * BLOCK; }
        else if (!strcmp(task, "sslope")) slope();
        else if (!strcmp(task, "speak")) lines();
        else return 2;
        double seconds = now() - begun, check = 0;
        for (int n = 0; n < SAMPLES; n += 4096) check += out[n];
        printf("%.9f %.0f %s\n", seconds, units, isfinite(check) ? "ok" : "infinite");
        fflush(stdout);
    }
    return 0;
}
