"""Writes ten minutes of AR texture to a WAV file with SciPy: the complete process, for comparison
with `htex synth`.
"""

import json
import sys

import numpy as np
from scipy.io import wavfile
from scipy.signal import lfilter, resample_poly

case, output, seconds = json.load(open(sys.argv[1])), sys.argv[2], float(sys.argv[3])
noise = np.random.default_rng(1).standard_normal(int(seconds * 2000))
texture = resample_poly(lfilter([1.0], np.concatenate([[1.0], -np.array(case["ar"])]), noise), 10, 1)
wavfile.write(output, 20_000, texture.astype(np.float32))
