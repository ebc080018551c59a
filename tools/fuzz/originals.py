"""Valid files, from which damaged ones are made."""

from __future__ import annotations

import io
import sqlite3
import tempfile
import wave
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np

from fingertip.catalogues.file_kinds import PARAMS, FileKind, list_bundled_files

RATE_HZ = 2000.0
_SAMPLES = 600


@cache
def recording() -> tuple[np.ndarray, np.ndarray]:
    """Times and voltages of a short recording with slip."""
    time_s = np.arange(_SAMPLES) / RATE_HZ
    voltage_v = 2.3 + np.random.default_rng(1).normal(0.0, 4e-4, _SAMPLES)
    return time_s, np.round(voltage_v + 0.01 * np.sin(2 * np.pi * 90 * time_s) * (time_s > 0.2), 6)


@cache
def recordings() -> Mapping[str, bytes]:
    """Recordings of each kind by the name of their file."""
    time_s, voltage_v = recording()
    files = {name: _saved(save) for name, save in _savers(time_s, voltage_v).items()}
    rows = [f"{t:.4f},{v:.6f}" for t, v in zip(time_s, voltage_v, strict=True)]
    files["plain.csv"] = "\n".join(["time_s,voltage_v", *rows, ""]).encode()
    files["semicolon.csv"] = files["plain.csv"].replace(b",", b";").replace(b".", b",")
    files["utf16.csv"] = files["plain.csv"].decode().encode("utf-16")
    dates = [
        f"2024-05-31T23:59:{59 + t:07.4f},{v:.6f}"
        for t, v in zip(time_s, voltage_v, strict=True)
        if t < 0.99
    ]
    files["dates.csv"] = "\n".join(["time_s,voltage_v", *dates, ""]).encode()
    head = "LabVIEW Measurement\t\nX_Columns\tOne\t\n***End_of_Header***\t\nX_Value\tAI0\tComment\n"
    files["trace.lvm"] = (head + "\n".join(row.replace(",", "\t") for row in rows)).encode()

    return files | {
        "trace.tdms": _tdms(voltage_v),
        "trace.wav": _wav(voltage_v),
        "trace.mat": _mat(time_s, voltage_v),
        "trace.parquet": _parquet(time_s, voltage_v),
    }


def _saved(save: object) -> bytes:
    assert callable(save)
    buffer = io.BytesIO()
    save(buffer)
    return buffer.getvalue()


def _savers(time_s: np.ndarray, voltage_v: np.ndarray) -> Mapping[str, object]:
    return {
        "plain.npz": lambda file: np.savez(file, time_s=time_s, voltage_v=voltage_v),
        "deflated.npz": lambda file: np.savez_compressed(
            file, voltage_v=voltage_v, sample_rate_hz=RATE_HZ
        ),
        "two.npy": lambda file: np.save(file, np.column_stack((time_s, voltage_v))),
        "one.npy": lambda file: np.save(file, voltage_v),
        "single.npz": lambda file: np.savez(
            file, time_s=time_s.astype("f4"), voltage_v=voltage_v.astype("f4")
        ),
    }


def _wav(voltage_v: np.ndarray) -> bytes:
    buffer = io.BytesIO()
    with wave.open(buffer, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(int(RATE_HZ))
        file.writeframes((voltage_v / 5.0 * 32767).astype("<i2").tobytes())

    return buffer.getvalue()


def _tdms(voltage_v: np.ndarray) -> bytes:
    from nptdms import ChannelObject, TdmsWriter

    buffer = io.BytesIO()
    with TdmsWriter(buffer) as writer:
        writer.write_segment(
            [ChannelObject("group", "AI0", voltage_v, properties={"wf_increment": 1 / RATE_HZ})]
        )

    return buffer.getvalue()


def _mat(time_s: np.ndarray, voltage_v: np.ndarray) -> bytes:
    from scipy.io import savemat

    return _saved(
        lambda file: savemat(file, {"time_s": time_s, "voltage_v": voltage_v}, do_compression=True)
    )


def _parquet(time_s: np.ndarray, voltage_v: np.ndarray) -> bytes:
    import pyarrow
    from pyarrow import parquet

    table = pyarrow.table({"time_s": time_s, "voltage_v": voltage_v})
    return _saved(lambda file: parquet.write_table(table, file))


@cache
def bundled(kind: FileKind) -> tuple[bytes, ...]:
    """Bundled files of a kind."""
    return tuple(path.read_bytes() for _, path in sorted(list_bundled_files(kind).items()))


@cache
def hands() -> tuple[bytes, ...]:
    """Bundled files of hands' sizes."""
    return tuple(path.read_bytes() for path in sorted((PARAMS / "hands").glob("*.toml")))


@cache
def weighings() -> bytes:
    """File of weighings of a sensor."""
    from fingertip.board.analysis.board_values import board_values
    from fingertip.design import Design
    from fingertip.sim.signal.bridge import fit_conductance_curve

    curve = fit_conductance_curve()
    response = board_values(Design()).tactile_response
    loads = (0.0, 50.0, 100.0, 200.0, 500.0, 1000.0)
    volts = (response.tactile_v(curve.conductance_s(g * 9.80665e-3)) for g in loads)

    return "\n".join(
        ["weight_g,voltage_v", *(f"{g:g},{v:.5f}" for g, v in zip(loads, volts, strict=True))]
    ).encode()


@cache
def sweep_database() -> bytes:
    """Database of a small finished sweep."""
    from fingertip.sweep.database import SweepDatabase
    from fingertip.sweep.sweep_plan import SweepPlan

    tables = {"outputs": ["cutoff_3db_hz"], "axes": {"board.cutoff_hz": [60.0, 67.0, 75.0]}}

    with tempfile.TemporaryDirectory() as folder:
        SweepDatabase.create(Path(folder), SweepPlan.from_tables(tables)).close()
        path = Path(folder) / "sweep.sqlite"
        with sqlite3.connect(path) as connection:
            connection.executemany(
                "INSERT INTO rows VALUES (?, 'ok', '', '', ?, ?)",
                [(i, f, 1.01 * f) for i, f in enumerate((60.0, 67.0, 75.0))],
            )

        connection.close()
        return path.read_bytes()


@cache
def board_folder() -> Mapping[str, bytes]:
    """Files of the default design's board, with their manifest."""
    from fingertip.design import Design
    from fingertip.tasks.board_files import write_board

    with tempfile.TemporaryDirectory() as folder:
        write_board(Design(), folder)
        return {
            path.name: path.read_bytes()
            for path in sorted(Path(folder).iterdir())
            if path.is_file()
        }
