"""Print the time of a sample, ns: the least of several runs over blocks of a length."""

import sys
import time

import numpy as np

import htex

SAMPLES = 1_920_000
path, model, length = sys.argv[1:]
voice = htex.open(path).voice(model=model, seed=7)
block = np.empty(int(length), dtype=np.float32)
least = float("inf")
for _ in range(5):
    start = time.perf_counter()
    for _ in range(SAMPLES // len(block)):
        voice.render_into(block)
    least = min(least, (time.perf_counter() - start) * 1e9 / (SAMPLES // len(block) * len(block)))
print(f"{least:.4f}")
