/* Written by `cargo xtask generate`. The models of libhtex, in its order; 0 is the one of least error. */
static const char *const MODELS[] = {"least error", "ar", "mfcc", "speak", "sbeta", "sslope", "bands", "arma", "map"};
