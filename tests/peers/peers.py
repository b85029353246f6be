"""Performs the same tasks with the tools that people use today: NumPy, SciPy, spectrum and librosa,
on one thread.

It speaks the protocol of tests/bench/src/peer.rs: it prints "ready TASK ..." and "skip TASK:
reason", then reads a task's name from each line and answers "seconds units ok". Argument: the
folder with case.json, spectrum.npy and recording.csv that the bench writes.
"""

import json
import os
import sys
import time

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[threads] = "1"

import numpy as np
from scipy import fft, optimize, signal, stats

folder = sys.argv[1]
case = json.load(open(os.path.join(folder, "case.json")))
frequency = np.arange(4, 201) * 5.0
magnitude = np.array(case["magnitude"])
rng = np.random.default_rng(1)
RATE = 20_000
N = 1 << 20
LONG = 10 * RATE
coefficients = np.concatenate([[1.0], -np.array(case["ar"])])
tasks = {}


def task(units):
    return lambda f: tasks.setdefault(f.__name__, (units, f))


def random_phase(curve):
    """Make ten seconds of noise under a curve, with one inverse transform."""
    bins = np.zeros(LONG // 2 + 1, complex)
    k = np.arange(200, 10_001)
    phase = rng.uniform(0, 2 * np.pi, k.size)
    bins[k] = curve(k / 10.0) * np.exp(1j * phase)
    return fft.irfft(bins, LONG)


@task(N)
def ar():
    return signal.lfilter([1.0], coefficients, rng.standard_normal(N))


@task(N)
def ar_edges():
    x = signal.lfilter([1.0], coefficients, rng.standard_normal(N))
    # 3 dB down at 17.5 Hz.
    return signal.sosfilt(signal.cheby1(4, 0.2, 20.234, "high", fs=2000, output="sos"), x)


@task(10 * (N // 10))
def ar_device():
    return signal.resample_poly(signal.lfilter([1.0], coefficients, rng.standard_normal(N // 10)), 10, 1)


@task(N)
def sslope():
    peak, rise, fall = case["sslope"]
    sos = np.vstack([signal.butter(int(rise), peak, "high", fs=RATE, output="sos"),
                     signal.butter(int(fall), peak, "low", fs=RATE, output="sos")])
    return signal.sosfilt(sos, rng.standard_normal(N))


@task(LONG)
def sbeta():
    alpha, beta = case["sbeta"]
    return random_phase(lambda f: stats.beta.pdf(np.log(f / 20) / np.log(50), alpha, beta))


@task(LONG)
def sbeta_irfft():
    """Run only the inverse transform; the curve is already computed."""
    return random_phase(lambda f, at=beta_curve: at)


beta_curve = stats.beta.pdf(np.log(np.arange(200, 10_001) / 200.0) / np.log(50), *case["sbeta"])


@task(LONG)
def speak():
    t = np.arange(LONG) / RATE
    return sum(a * np.cos(2 * np.pi * f * t) for f, a in zip(*case["speak"]))


def hz_to_mel(f):
    return 2595 * np.log10(1 + f / 700)


def mel_bank(bands=26):
    edges = 700 * (10 ** (np.linspace(hz_to_mel(20), hz_to_mel(1000), bands + 2) / 2595) - 1)
    up = (frequency - edges[:-2, None]) / (edges[1:-1] - edges[:-2])[:, None]
    down = (edges[2:, None] - frequency) / (edges[2:] - edges[1:-1])[:, None]
    return np.clip(np.minimum(up, down), 0, None)


@task(LONG)
def mfcc():
    """Run the pseudo-inverse, and one inverse transform."""
    energy = np.exp(fft.idct(np.pad(case["mfcc"], (0, 26 - len(case["mfcc"]))), norm="ortho"))
    power = np.clip(np.linalg.pinv(mel_bank()) @ energy, 0, None)
    return random_phase(lambda f: np.interp(f, frequency, np.sqrt(power)))


@task(2 * 22_050)
def mfcc_librosa():
    import librosa

    frames = np.repeat(np.array(case["mfcc"])[:, None] * 10 / np.log(10), 87, axis=1)
    return librosa.feature.inverse.mfcc_to_audio(frames, n_mels=26, sr=22_050, fmin=20, fmax=1000)


def peaks_of(spectrum):
    at, _ = signal.find_peaks(spectrum)
    kept = []
    for i in at[np.argsort(-spectrum[at], kind="stable")]:
        f = frequency[i]
        if all(abs(f - g) / min(f, g) >= 0.12 for g in frequency[kept]) and len(kept) < 10:
            kept.append(i)
    return sorted(kept)


def fit_ar(spectrum):
    power = np.zeros(201)
    power[4:] = spectrum ** 2
    lags = fft.irfft(power)[:7]
    from scipy.linalg import solve_toeplitz

    return solve_toeplitz(lags[:6], lags[1:7])


def fit_sbeta(spectrum):
    kept = peaks_of(spectrum)
    u, y = np.log(frequency[kept] / 20) / np.log(50), spectrum[kept]

    def loss(p):
        shape = stats.beta.pdf(u, 1 + p[0] ** 2, 1 + p[1] ** 2)
        scale = shape @ y / max(shape @ shape, 1e-300)
        return np.sum((scale * shape - y) ** 2)

    exact = {"xatol": 1e-10, "fatol": 1e-10}  # As ours.
    starts = [(2, 2), (1.5, 3), (3, 1.5), (4, 4)]
    return min((optimize.minimize(loss, np.sqrt(np.array(s) - 1), method="Nelder-Mead",
                                  options=exact) for s in starts),
               key=lambda r: r.fun).x


def fit_sslope(spectrum):
    i = int(np.argmax(spectrum))
    db, x = 20 * np.log10(np.maximum(spectrum, 1e-20)), np.log10(frequency)
    return [np.polyfit(x[part], db[part], 1)[0] if db[part].size > 1 else 0.0
            for part in (slice(0, i + 1), slice(i, None))]


@task(1)
def fit():
    fit_ar(magnitude)
    fft.dct(np.log(np.maximum(mel_bank() @ magnitude ** 2, 1e-20)), norm="ortho")[:10]
    peaks_of(magnitude)
    fit_sbeta(magnitude)
    return fit_sslope(magnitude)


@task(1)
def fit_ar_spectrum():
    """Run Burg's method on the signal, with the package spectrum."""
    import spectrum

    return spectrum.arburg(np.array(case["signal"]), 6)[0]


@task(1)
def process():
    file = os.path.join(folder, "recording.csv")
    with open(file) as lines:
        header = next(i for i, line in enumerate(lines) if line[0] in "-0123456789")
    data = np.loadtxt(file, delimiter=",", skiprows=header)
    fx, fy = data[:, 1], data[:, 2]
    r = np.hypot(fx, fy)
    width = 1001
    smooth = np.convolve(r, np.ones(width), "same") / np.convolve(np.ones(r.size), np.ones(width), "same")
    above = np.concatenate([[0], (smooth > r.mean()).astype(int), [0]])
    starts, ends = np.flatnonzero(np.diff(above) == 1), np.flatnonzero(np.diff(above) == -1)
    window = signal.get_window("hann", 4000)
    found = []
    for s, e in zip(starts, ends):
        middle = (s + e) // 2
        if e - s >= 4000 and middle >= 2000 and middle + 2000 <= r.size:
            part = [x[middle - 2000:middle + 2000] for x in (fx, fy)]
            x, y = (fft.rfft((p - p.mean()) * window) for p in part)
            found.append(np.sqrt(abs(x) ** 2 + abs(y) ** 2)[4:201])
    return np.mean(found, axis=0) * 2 / window.sum()


def available():
    for name in tasks:
        needs = {"mfcc_librosa": "librosa", "fit_ar_spectrum": "spectrum"}.get(name)
        try:
            if needs:
                __import__(needs)
            yield name
        except ImportError as error:
            print(f"skip {name}: {error}")


if __name__ == "__main__":
    print("ready", *available(), flush=True)
    for line in sys.stdin:
        units, run = tasks[line.strip()]
        begun = time.perf_counter()
        result = run()
        seconds = time.perf_counter() - begun
        print(f"{seconds:.9f} {units}", "ok" if np.all(np.isfinite(result)) else "infinite", flush=True)
