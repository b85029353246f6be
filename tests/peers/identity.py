"""How well a texture of so many bytes still names its material.

    python tests/peers/identity.py FOLDER --htex htex [--json JSON] [--figure SVG]

FOLDER contains recordings of several takes of each material, NAME_0.wav, NAME_1.wav, ... as in
dexrob/BioTac_slide_20_50, which may not be passed on. Every model is fitted with `htex fit`, and its
spectrum is read with `htex spectrum`. One half of the takes is known and the other half is tested,
in both directions.

- *of all*: one asset a material, fitted to all known takes, names each tested take.
- *of one*: one asset is fitted to each tested take, and the known takes name it.
- *less common*: as *of one*, after the error that the model has on all materials alike is removed.
  This error is the mean difference, in each third octave, between the assets that are fitted to one
  known take each, and these takes.

A name is the material whose mean is nearest, in decibels in third octaves with their level, after a
linear discriminant analysis: the distance is Mahalanobis's, with the covariance of the known takes
within their materials. A tenth of this covariance is replaced by as much variance in all third
octaves alike, because a hundred takes determine 17 x 17 numbers badly. *+-* is one standard error of
*of one*, by a bootstrap over the materials.

The script needs only NumPy. It prints a table in Markdown. `--json` also writes the error of each
setting in each third octave, `--figure` a picture.
"""

import argparse
import concurrent.futures
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

EDGES_HZ = 20 * 2 ** (np.arange(18) / 3)
SHRINKAGE = 0.1
DRAWS = 2000
# Models with options, as in `--option`.
SETTINGS = [
    ("bands", "step_db=0.5"),
    ("bands", ""),
    ("bands", "step_db=2"),
    ("bands", "step_db=3"),
    ("bands", "bands=20 step_db=1.5"),
    ("bands", "bands=16 step_db=3"),
    ("bands", "bands=12 step_db=3"),
    ("bands", "bands=9"),
    ("bands", "bands=6 step_db=3"),
    ("bands", "bands=1"),
    ("bands", "bands=64"),
    ("ar", "order=4"),
    ("ar", ""),
    ("ar", "order=8"),
    ("ar", "order=12"),
    ("ar", "order=32"),
    ("ar", "method=decibel order=4"),
    ("ar", "method=decibel"),
    ("ar", "method=decibel order=7"),
    ("ar", "method=decibel order=8"),
    ("ar", "method=decibel order=12"),
    ("mfcc", "coefficients=6"),
    ("mfcc", ""),
    ("mfcc", "coefficients=26"),
    ("mfcc", "inverse=nnls"),
    ("mfcc", "inverse=interpolate"),
    ("mfcc", "inverse=log-log"),
    ("mfcc", "fit=decibel"),
    ("mfcc", "inverse=log-log fit=decibel coefficients=6"),
    ("mfcc", "inverse=log-log fit=decibel"),
    ("mfcc", "inverse=log-log fit=decibel coefficients=13"),
    ("speak", ""),
    ("speak", "count=64"),
    ("sbeta", ""),
    ("sbeta", "bins=40"),
    ("sslope", ""),
    ("arma", ""),
]
COLOURS = {
    "bands": "#006b7a", "ar": "#d55e00", "mfcc": "#0072b2", "speak": "#cc79a7", "sbeta": "#009e73", "sslope": "#e69f00", "arma": "#7f3c8d",
}
# The figure shows settings with both of MFCC's improvements, and settings without any.
IMPROVED = ("method=decibel", "inverse=log-log fit=decibel")
NEW = ("decibel", "log-log")


class Htex:
    """The command, with its temporary folder."""

    def __init__(self, command, folder):
        self.command, self.folder = command, pathlib.Path(folder)

    def run(self, *arguments):
        done = subprocess.run([self.command, *map(str, arguments)], capture_output=True, text=True)
        if done.returncode:
            raise SystemExit(f"{self.command} {' '.join(map(str, arguments))}: {done.stderr}")
        return done.stdout

    def recorded(self, take):
        return third_octaves(self.run("process", take, "--quantity", "acceleration", "--quiet"))

    def fitted(self, takes, model, options):
        """Return third octaves, dB, and bytes of the parameters of an asset of these takes."""
        with tempfile.NamedTemporaryFile(dir=self.folder, suffix=".htex") as file:
            words = [word for option in options.split() for word in ("--option", f"{model}.{option}")]
            fit = self.run("fit", *takes, "--quantity", "acceleration", "--model", model, *words, "--json", "-o", file.name)
            spectrum = self.run("spectrum", file.name, "--model", model, "--quiet")
            return third_octaves(spectrum), json.loads(fit)["representations"][0]["payload_bytes"]


def third_octaves(table):
    """Return the energies in third octaves, dB, of a table of frequencies and magnitudes."""
    hertz, magnitude = np.array([line.split(",") for line in table.split()[1:]], dtype=float).T
    bands = zip(EDGES_HZ, EDGES_HZ[1:])
    energies = [np.sum(magnitude[(hertz >= low * (1 - 1e-12)) & (hertz < high * (1 - 1e-12))] ** 2) for low, high in bands]
    # A third octave without energy counts as 300 dB below the unit.
    return 10 * np.log10(np.maximum(energies, 1e-30))


def within(known):
    """Return the inverse of the covariance within materials of known[material, take, third octave]."""
    materials, takes, size = known.shape
    away = (known - known.mean(axis=1, keepdims=True)).reshape(-1, size)
    covariance = away.T @ away / (materials * (takes - 1))
    alike = np.trace(covariance) / size * np.eye(size)
    return np.linalg.inv((1 - SHRINKAGE) * covariance + SHRINKAGE * alike)


def named(spectra, means, inverse):
    """Return, for spectra[material, take, third octave], the part of each material that is named right."""
    away = spectra[:, :, None] - means
    nearest = np.argmin(np.einsum("mtki,ij,mtkj->mtk", away, inverse, away), axis=2)
    return np.mean(nearest == np.arange(len(means))[:, None], axis=1)


def standard_error(parts):
    """Return the standard error of the mean of the parts of all materials."""
    random = np.random.default_rng(1)
    return float(np.std([random.choice(parts, len(parts)).mean() for _ in range(DRAWS)]))


def judge(real, ones, alls, halves):
    """Return the parts named right, from recorded[material, take], of one take each, and of each half."""
    found = {"all": [], "one": [], "less_common": []}
    for (known, tested), of_all in zip((halves, halves[::-1]), alls):
        inverse, means = within(real[:, known]), real[:, known].mean(axis=1)
        common = (ones[:, known] - real[:, known]).mean(axis=(0, 1))
        found["all"].append(named(real[:, tested], of_all, inverse))
        found["one"].append(named(ones[:, tested], means, inverse))
        found["less_common"].append(named(ones[:, tested] - common, means, inverse))
    parts = {name: np.mean(both, axis=0) for name, both in found.items()}
    error = ones - real
    return {
        **{name: float(np.mean(part)) for name, part in parts.items()},
        "standard_error": standard_error(parts["one"]),
        "error_db": float(np.sqrt(np.mean(error**2))),
        "common_error_db": [round(float(e), 2) for e in error.mean(axis=(0, 1))],
        "own_error_db": float(np.sqrt(np.mean((error - error.mean(axis=(0, 1))) ** 2))),
    }


def measure(htex, materials, takes, settings, threads):
    """Return a dictionary for each setting; the first is that of the recordings themselves."""
    count = len(takes[0])
    halves = [list(range(count // 2)), list(range(count // 2, count))]
    with concurrent.futures.ThreadPoolExecutor(threads) as pool:
        real = np.array([list(pool.map(htex.recorded, row)) for row in takes])
        means = [10 * np.log10(np.mean(10 ** (real[:, half] / 10), axis=1)) for half in halves]
        rows = [{"model": "recordings", "options": "", "bytes": None, **judge(real, real, means, halves)}]
        for model, options in settings:
            fit = lambda row: htex.fitted(row, model, options)
            single = list(pool.map(fit, [[take] for row in takes for take in row]))
            ones = np.array([one for one, _ in single]).reshape(real.shape)
            alls = [np.array([s for s, _ in pool.map(fit, [[row[i] for i in half] for row in takes])]) for half in halves]
            size = float(np.median([size for _, size in single]))
            rows.append({"model": model, "options": options, "bytes": size, **judge(real, ones, alls, halves)})
            print(f"{model} {options}: {rows[-1]['one']:.3f}", file=sys.stderr)
    return rows


def table(rows):
    lines = ["| model | bytes | of all | of one | +- | less common | error / dB | own error / dB |", "|---" * 8 + "|"]
    for row in rows:
        name = f"{row['model']} {row['options']}".strip()
        percent = [f"{100 * row[key]:.1f}" for key in ("all", "one", "standard_error", "less_common")]
        size = "-" if row["bytes"] is None else f"{row['bytes']:.0f}"
        lines.append("| " + " | ".join([name, size, *percent, f"{row['error_db']:.2f}", f"{row['own_error_db']:.2f}"]) + " |")
    return "\n".join(lines)


def figure(rows):
    """Return an SVG: the part named right of assets of one take, over the bytes of the parameters."""
    width, height, left, top, right, bottom = 640, 410, 56, 32, 150, 46
    x = lambda size: left + (width - left - right) * np.log(size / 4) / np.log(600 / 4)
    y = lambda part: height - bottom - (height - top - bottom) * part
    text = lambda px, py, words, anchor="middle": f'<text x="{px:.1f}" y="{py:.1f}" text-anchor="{anchor}">{words}</text>'
    line = lambda x1, y1, x2, y2, style: f'<path d="M{x1:.1f} {y1:.1f}L{x2:.1f} {y2:.1f}" {style}/>'
    out = []
    for size in (5, 10, 20, 50, 100, 200, 500):
        out += [line(x(size), y(0), x(size), y(1), 'stroke="#e4e4e4"'), text(x(size), y(0) + 16, size)]
    for percent in range(0, 101, 20):
        out += [line(left, y(percent / 100), width - right, y(percent / 100), 'stroke="#e4e4e4"'), text(left - 6, y(percent / 100) + 4, percent, "end")]
    out += [text((left + width - right) / 2, height - 8, "bytes of parameters"), text(8, 16, "materials named right / %", "start")]
    real = y(rows[0]["one"])
    out += [line(left, real, width - right, real, 'stroke="#4d4d4d" stroke-dasharray="5 3"'), text(width - right + 6, real + 4, "the takes themselves", "start")]
    legend = top + 44
    for model in COLOURS:
        for improved in (False, True):
            # Only the front: no setting of the model has fewer bytes and a better name.
            own = [r for r in rows if r["model"] == model]
            of = [r for r in own if r["options"].startswith(IMPROVED)] if improved else [r for r in own if not any(w in r["options"] for w in NEW)]
            front = sorted((r for r in of if not any(o["bytes"] <= r["bytes"] and o["one"] > r["one"] for o in of)), key=lambda r: r["bytes"])
            if not front:
                continue
            fill = "#fff" if improved else COLOURS[model]
            path = "M" + "L".join(f"{x(r['bytes']):.1f} {y(r['one']):.1f}" for r in front)
            out.append(f'<path d="{path}" fill="none" stroke="{COLOURS[model]}" stroke-width="1.5"{" stroke-dasharray=" + chr(34) + "3 2" + chr(34) if improved else ""}/>')
            dot = lambda px, py, words: f'<circle cx="{px:.1f}" cy="{py:.1f}" r="4" fill="{fill}" stroke="{COLOURS[model]}" stroke-width="1.5"><title>{words}</title></circle>'
            out += [dot(x(r["bytes"]), y(r["one"]), f"{model} {r['options']}: {r['bytes']:.0f} bytes, {100 * r['one']:.1f} %") for r in front]
            name = f"{model}, in decibels" if improved else model
            out += [dot(width - right + 12, legend, name), text(width - right + 22, legend + 4, name, "start")]
            legend += 18
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" role="img"'
    style = "aria-label=\"Materials named right, over bytes\" font-family=\"system-ui, 'DejaVu Sans', sans-serif\" font-size=\"11\" fill=\"#222\" style=\"color-scheme:light\""
    return f'{head} {style}><rect width="{width}" height="{height}" fill="#fff"/>{"".join(out)}</svg>\n'


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--htex", default="htex", help="the command [default: htex]")
    parser.add_argument("--only", action="append", help="only this model; may be given several times")
    parser.add_argument("--threads", type=int, default=2, help="commands at a time [default: 2]")
    parser.add_argument("--json", type=pathlib.Path, help="also write the results to this file")
    parser.add_argument("--figure", type=pathlib.Path, help="also draw the results into this SVG file")
    chosen = parser.parse_args()
    materials = sorted(path.stem.removesuffix("_0") for path in chosen.folder.glob("*_0.wav"))
    takes = [sorted(chosen.folder.glob(f"{material}_*.wav"), key=lambda p: int(p.stem.rsplit("_", 1)[1])) for material in materials]
    if not takes or len({len(row) for row in takes}) != 1 or len(takes[0]) < 4:
        parser.error(f"{chosen.folder} does not contain equally many takes of each material, at least four: NAME_0.wav, NAME_1.wav, ...")
    settings = [s for s in SETTINGS if not chosen.only or s[0] in chosen.only]
    with tempfile.TemporaryDirectory() as place:
        rows = measure(Htex(chosen.htex, place), materials, takes, settings, chosen.threads)
    print(f"{len(materials)} materials, {len(takes[0])} takes each; chance: {100 / len(materials):.1f} %\n")
    print(table(rows))
    if chosen.json:
        chosen.json.write_text(json.dumps(rows, indent=1) + "\n")
    if chosen.figure:
        chosen.figure.write_text(figure(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
