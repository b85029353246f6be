"""Writes the small files of this folder, and expected.json with their numbers as the same libraries read them back.

    pip install numpy scipy h5py npTDMS pyarrow soundfile
    python make.py
"""

import json
import struct
from pathlib import Path

import h5py
import nptdms
import numpy as np
import pyarrow as pa
import pyarrow.feather
import pyarrow.parquet
import scipy
import scipy.io
import soundfile

HERE = Path(__file__).parent
RATE_HZ = 2000
ROWS = 96

t = np.arange(ROWS) / RATE_HZ
random = np.random.default_rng(11)
fx = 0.1 * np.sin(2 * np.pi * 80 * t) + 0.01 * random.standard_normal(ROWS)
fy = 0.05 * np.cos(2 * np.pi * 120 * t) + 0.01 * random.standard_normal(ROWS)
fz = -0.4 + 0.02 * random.standard_normal(ROWS)
counts = np.round(1000 * fx).astype(np.int16)

expected = {}


def note(name, library, columns, rate_hz=None):
    expected[name] = {
        "library": library,
        "rate_hz": rate_hz,
        "columns": {key: [float(x) for x in values] for key, values in columns.items()},
    }


def samples():
    forces = np.stack([fx, fy, fz, 0.5 * fx], axis=1)
    for name, channels, options in [
        ("pcm16.wav", 4, dict(format="WAV", subtype="PCM_16")),
        ("pcm8.wav", 2, dict(format="WAV", subtype="PCM_U8")),
        ("extensible24.wav", 4, dict(format="WAVEX", subtype="PCM_24")),
        ("extensible_float.wav", 3, dict(format="WAVEX", subtype="FLOAT")),
        ("pcm32.wav", 1, dict(format="WAV", subtype="PCM_32")),
        ("pcm16.flac", 4, dict(format="FLAC", subtype="PCM_16")),
        ("pcm24.flac", 2, dict(format="FLAC", subtype="PCM_24")),
    ]:
        soundfile.write(HERE / name, forces[:, :channels], RATE_HZ, **options)
        read, rate_hz = soundfile.read(HERE / name, always_2d=True)
        columns = {f"ch{i + 1}": read[:, i] for i in range(channels)}
        note(name, f"soundfile {soundfile.__version__}", columns, rate_hz)


def matlab():
    run = {"forces": np.stack([fx, fy, fz], axis=1), "fs": float(RATE_HZ), "label": "cloth"}
    variables = {
        "t": t,
        "fx_n": fx.reshape(1, -1),
        "fz_n": fz.astype(np.float32).reshape(-1, 1),
        "counts": counts,
        "run": {**run, "deep": {"x": np.arange(ROWS, dtype=np.uint8)}},
        "runs": np.array([(fx,), (fy,)], dtype=[("f", object)]),
        "wide": np.stack([fx, fy]),
        "z": fx + 1j * fy,
        "note": "made by SciPy",
    }
    for name, compress in [("plain.mat", False), ("compressed.mat", True)]:
        scipy.io.savemat(HERE / name, variables, do_compression=compress, oned_as="column")
        read = scipy.io.loadmat(HERE / name, squeeze_me=True)
        run = read["run"]
        columns = {key: read[key] for key in ("t", "fx_n", "fz_n", "counts")}
        columns |= {f"run.forces#{i + 1}": run["forces"].item()[:, i] for i in range(3)}
        columns |= {f"runs({i + 1}).f": read["runs"]["f"][i] for i in range(2)}
        columns |= {"run.deep.x": run["deep"].item()["x"].item()}
        columns |= {f"wide#{i + 1}": read["wide"][i] for i in range(2)}
        note(name, f"scipy {scipy.__version__}", columns, run["fs"].item())


def hdf5():
    def write(file, **options):
        one = file.create_group("run1")
        one.create_dataset("fx_n", data=fx, **options)
        one.create_dataset("fz", data=fz.astype(">f4"), **options)
        one.create_dataset("counts", data=counts, **options)
        one["fx_n"].attrs["sample_rate"] = float(RATE_HZ)
        two = file.create_group("run2/deep")
        two.create_dataset("forces", data=np.stack([fx, fy, fz], axis=1), **options)
        two.attrs["rate_hz"] = 2 * RATE_HZ
        two.create_dataset("label", data="cloth")
        two.create_dataset("table", data=np.zeros(4, dtype=[("a", "f8"), ("b", "i4")]))

    for name, library, options in [
        ("earliest.h5", "earliest", {}),
        ("chunked.h5", "earliest", dict(chunks=True, compression="gzip", shuffle=True, fletcher32=True)),
        ("latest.h5", "latest", dict(chunks=True, compression="gzip", maxshape=None)),
    ]:
        with h5py.File(HERE / name, "w", libver=library) as file:
            write(file, **options)
        with h5py.File(HERE / name, "r") as file:
            columns = {f"/run1/{key}": file[f"/run1/{key}"][()] for key in ("fx_n", "fz", "counts")}
            columns |= {f"/run2/deep/forces#{i + 1}": file["/run2/deep/forces"][:, i] for i in range(3)}
            rate_hz = float(file["/run1/fx_n"].attrs["sample_rate"])
        note(name, f"h5py {h5py.__version__}", columns, rate_hz)

    # The layout of MATLAB's version 7.3: a block of 512 bytes before the signature, dimensions in reverse.
    name = "version73.mat"
    with h5py.File(HERE / name, "w", userblock_size=512) as file:
        file["fx_n"] = fx.reshape(1, -1)
        file["run/forces"] = np.stack([fx, fy, fz])
        file["run/fs"] = [[float(RATE_HZ)]]
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\0\2IM"
    with open(HERE / name, "r+b") as file:
        file.write(head)
    with h5py.File(HERE / name, "r") as file:
        columns = {"/fx_n": file["fx_n"][0]}
        columns |= {f"/run/forces#{i + 1}": file["run/forces"][i] for i in range(3)}
        rate_hz = float(file["run/fs"][0, 0])
    note(name, f"h5py {h5py.__version__}", columns, rate_hz)


def arrow():
    table = pa.table(
        {
            "t_s": t,
            "fx_n": fx,
            "fz": pa.array(fz, pa.float32()),
            "counts": counts,
            "surface": ["cloth"] * ROWS,
            "steps": pa.array(np.arange(ROWS) // 7, pa.int64()),
        }
    )

    def numbers(read):
        return {name: read[name].to_numpy() for name in ("t_s", "fx_n", "fz", "counts", "steps")}

    library = f"pyarrow {pa.__version__}"
    parquet = pyarrow.parquet
    for name, options in [
        ("snappy.parquet", dict(compression="snappy", row_group_size=40)),
        ("gzip.parquet", dict(compression="gzip", use_dictionary=False)),
        ("plain.parquet", dict(compression="none", use_dictionary=False, data_page_version="2.0")),
        ("lz4.parquet", dict(compression="lz4", use_dictionary=False)),
    ]:
        parquet.write_table(table, HERE / name, **options)
        note(name, library, numbers(parquet.read_table(HERE / name)))
    for name, options in [
        ("lz4.feather", dict(compression="lz4", chunksize=40)),
        ("plain.arrow", dict(compression="uncompressed")),
    ]:
        pyarrow.feather.write_feather(table, str(HERE / name), **options)
        note(name, library, numbers(pyarrow.feather.read_table(str(HERE / name))))
    with pa.ipc.new_stream(str(HERE / "stream.arrows"), table.schema) as stream:
        stream.write_table(table, max_chunksize=50)
    with pa.ipc.open_stream(str(HERE / "stream.arrows")) as stream:
        note("stream.arrows", library, numbers(stream.read_all()))

    # What the command refuses, with what to do.
    parquet.write_table(table, HERE / "zstd.parquet", compression="zstd")
    parquet.write_table(pa.table({"fx_n": fx}), HERE / "split.parquet", use_dictionary=False, use_byte_stream_split=True)
    with_null = pa.table({"fx_n": [0.1, None, 0.3]})
    parquet.write_table(with_null, HERE / "null.parquet")
    pyarrow.feather.write_feather(with_null, str(HERE / "null.feather"), compression="uncompressed")
    pyarrow.feather.write_feather(table, str(HERE / "zstd.feather"), compression="zstd")


def labview():
    step = {"wf_increment": 1 / RATE_HZ, "wf_samples": ROWS}
    name = "segments.tdms"
    with nptdms.TdmsWriter(HERE / name) as file:
        for part in (slice(0, 40), slice(40, 80), slice(80, ROWS)):
            file.write_segment(
                [
                    nptdms.ChannelObject("Run 1", "fx_n", fx[part], properties=step),
                    nptdms.ChannelObject("Run 1", "fz", fz[part].astype(np.float32), properties=step),
                    nptdms.ChannelObject("Run 2", "it's/raw", counts[part], properties={"wf_increment": 1e-3}),
                ]
            )
        file.write_segment([nptdms.ChannelObject("Notes", "what", ["cloth", "dry"])])
    labview_note(name)

    # npTDMS does not write interleaved or big-endian values, but reads them.
    def text(value):
        return struct.pack(">I", len(value)) + value.encode()

    def attribute(key, value):
        return text(key) + struct.pack(">Id", 10, value)

    def channel(path, kind):
        index = struct.pack(">IIIQ", 20, kind, 1, ROWS // 2)
        return text(path) + index + struct.pack(">I", 1) + attribute("wf_increment", 1 / RATE_HZ)

    metadata = struct.pack(">I", 2) + channel("/'Run 1'/'fx_n'", 10) + channel("/'Run 1'/'counts'", 2)
    rows = b"".join(struct.pack(">dh", x, n) for x, n in zip(fx, counts))
    contents = 2 | 4 | 8 | 32 | 64
    sizes = struct.pack(">IQQ", 4713, len(metadata) + len(rows), len(metadata))
    name = "interleaved.tdms"
    (HERE / name).write_bytes(b"TDSm" + struct.pack("<I", contents) + sizes + metadata + rows)
    labview_note(name)


def labview_note(name):
    file = nptdms.TdmsFile.read(HERE / name)
    columns = {
        f"{group.name}/{channel.name}": channel[:]
        for group in file.groups()
        for channel in group.channels()
        if group.name != "Notes"
    }
    note(name, f"npTDMS {nptdms.__version__}", columns, RATE_HZ)


samples()
matlab()
hdf5()
arrow()
labview()
text = ",\n".join(f"{json.dumps(name)}: {json.dumps(entry)}" for name, entry in expected.items())
(HERE / "expected.json").write_text("{\n" + text + "\n}\n")
