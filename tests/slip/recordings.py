"""Recordings for tests, and the command line in this process."""

from __future__ import annotations

import datetime
import io
import json
import zipfile

import numpy as np
from typer.testing import CliRunner

from fingertip.cli import app
from fingertip.design import Design
from fingertip.slip.detectors.registry import make_detector


def run(*words, lines=None):
    return CliRunner().invoke(app, [str(word) for word in words], input=lines)


def burst(rate: float = 2000.0) -> tuple[np.ndarray, np.ndarray]:
    """One second with slip from 0.5 to 0.7 s."""
    t = np.arange(int(rate)) / rate
    volts = 2.3 + np.random.default_rng(1).normal(0, 4e-4, len(t))
    return t, volts + 0.01 * np.sin(2 * np.pi * 90 * t) * ((t >= 0.5) & (t < 0.7))


def csv(t, v, delimiter=",", header=("time_s", "voltage_v"), comma=False) -> str:
    lines = [
        delimiter.join(header),
        *(f"{a:.6f}{delimiter}{b:.6f}" for a, b in zip(t, v, strict=True)),
    ]
    return (
        "\n".join([lines[0], *(line.replace(".", ",") if comma else line for line in lines[1:])])
        + "\n"
    )


def single_onset(done) -> float:
    """Onset of the only interval that `fingertip detect --json` printed [s]."""
    assert done.exit_code == 0, done.stderr
    (interval,) = json.loads(done.stdout)["intervals"]
    return interval["onset_s"]


T, V = burst()
PLAIN = csv(T, V)
ONSET = float(T[np.flatnonzero(make_detector("digital", Design()).process(np.round(V, 6)).on)[0]])

START = datetime.datetime(2024, 5, 31, 23, 59, 59, 700_000)  # midnight falls into the recording


def rows(times, delimiter=",", volts=V) -> str:
    return "".join(f"{a}{delimiter}{b:.6f}\n" for a, b in zip(times, volts, strict=True))


def iso(form: str) -> list[str]:
    moments = [START + datetime.timedelta(seconds=float(t)) for t in T]
    return [form.format(moment.isoformat(timespec="microseconds"), moment) for moment in moments]


def lvm(x_columns: str, segments: int = 1) -> str:
    """Text of a LabVIEW measurement file with tabs and one channel."""
    text = (
        "LabVIEW "
        "Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n"
        f"Multi_Headings\t{'Yes' if segments > 1 else 'No'}\nX_Columns\t{x_columns}\nTime_Pref\tRelative\n"  # noqa: E501
        "Date\t2024/05/31\nTime\t12:00:00.5\n***End_of_Header***\t\n\n"
    )
    step = len(T) // segments
    for first in range(0, len(T), step):
        part = slice(first, first + step)
        text += (
            f"Channels\t1\t\nSamples\t{step}\t\nDate\t2024/05/31\t\nTime\t12:00:00.5\t\nY_Unit_Label\tVolts\t\n"
            f"X_Dimension\tTime\t\nX0\t{T[first]:E}\t\nDelta_X\t0.000500\t\n***End_of_Header***\t\t\n"
            "X_Value\tVoltage\tComment\n"
        )
        lines = [
            f"{'' if x_columns == 'No' else f'{t:.6f}'}\t{v:.6f}"
            for t, v in zip(T[part], V[part], strict=True)
        ]
        lines[0] += "\tpressed"
        text += "\n".join(lines) + "\n"
    return text


DATES = iso("{0}")


def zip_of(*names: str) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        for name in names:
            archive.writestr(name, "x")
    return data.getvalue()
