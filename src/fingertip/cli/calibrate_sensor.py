"""Command `fingertip calibrate sensor`: turn weighings of the finger into the force curve of its sensor."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fingertip.cli.console import (
    Console,
    JsonOption,
    QuietOption,
    SetOption,
    command,
)
from fingertip.cli.options import CalibratedDesignOption, ForceCalibratedOption
from fingertip.cli.output_files import find_file_issues

if TYPE_CHECKING:
    from fingertip.calibration.calibrate_sensor import SensorCalibration
    from fingertip.design import Design


@command
def sensor(
    readings: Annotated[
        Path,
        typer.Argument(
            help="CSV file of weighings: a column weight_g or force_n, and one of voltage_v, counts or resistance_ohm."
        ),
    ],
    design: Annotated[
        Path | None,
        typer.Argument(help="Design of the board that took the readings; the default design if left out."),
    ] = None,
    out: CalibratedDesignOption = None,
    force: ForceCalibratedOption = False,
    scale: Annotated[float | None, typer.Option("--scale", help="Volts per count, if the readings are counts.")] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Calibrate the force curve of a sensor, from readings under known weights.

    Real sensors of one model differ by factors at the same force. Four weighings or more, over the range of forces that
    matters, give the power law of this one: the conductance follows from each reading and the design's board, and least
    squares of the logarithms give curve and 95 % interval. Readings without load (weight 0) correct the board's offset;
    without one, the command warns.

    Exit code 0: the force curve is calibrated, 2: the weighings are not usable.
    """
    from fingertip.calibration.calibrate_sensor import apply_sensor_calibration, calibrate_sensor, list_warnings
    from fingertip.calibration.weighings import read_weighings
    from fingertip.cli.load import load_design
    from fingertip.design.export import to_toml
    from fingertip.errors import FingertipError
    from fingertip.files import write_file

    console = Console(as_json, quiet)
    remedy = "" if force else "overwrite it with --force"
    issues = list(find_file_issues("--out", out, ".toml", inputs=(readings, design), kept=remedy))
    loaded = weighings = None
    try:
        loaded, _ = load_design(design, changes, console.progress)
    except FingertipError as error:
        issues += error.issues
    try:
        weighings = read_weighings(readings)
    except FingertipError as error:
        issues += error.issues
    if issues or loaded is None or weighings is None:
        raise FingertipError(issues)
    calibration = calibrate_sensor(loaded, weighings, scale)
    calibrated = apply_sensor_calibration(loaded, calibration)
    data, lines = _data(calibration), _format(calibration, calibrated)
    data["warnings"] = list_warnings(weighings)
    for warning in data["warnings"]:
        console.progress(f"warning: {warning}")
    if out is not None:
        heading = f"{loaded.name}, with the force curve of one sensor on one board, by `fingertip calibrate sensor`."
        write_file(out, to_toml(calibrated, heading).encode())
        data["file"] = out.as_posix()
        lines.append(f"wrote {out}; next: fingertip simulate {shlex.quote(out.as_posix())}")
    console.result(data, "\n".join(lines))


def _format(calibration: SensorCalibration, calibrated: Design) -> list[str]:
    """Format the fit, the curve with its intervals, and the values as --set text."""
    from fingertip.design.force_curve import describe_force_curve

    law = calibration.law
    half = law.coverage_factor * law.exponent_uncertainty
    lines = [
        f"exponent {law.exponent:.3f} +- {half:.3f}, conductance {1e6 * law.conductance_s:.4g} uS 1 N above the "
        f"turn-on at {law.turn_on_n:g} N, scatter {100 * law.scatter:.1f} % (95 %, Student's t = "
        f"{law.coverage_factor:.2f} of {law.count - 2} degrees of freedom, {law.count} weighings)",
        f"{calibration.ratio_to_typical:.2g} times the conductance of the typical sensor",
    ]
    if calibration.offset_v:
        lines.append(f"offset of the board without load: {1000 * calibration.offset_v:+.1f} mV, taken off the readings")
    lines.append(f"{'force':>8} {'sensor':>12} {'tactile voltage':>16}   95 % interval of a force read off it")
    lines += (
        f"{point.force_n:6.2f} N {_format_ohm(1 / point.conductance_s):>8} ohm {point.voltage_v:14.3f} V   "
        f"{point.low_n:.2f} to {point.high_n:.2f} N"
        for point in calibration.points
    )
    lines.append(describe_force_curve(calibrated))
    return [*lines, " ".join(f"--set {path}={value}" for path, value in calibration.changes.items())]


def _format_ohm(resistance_ohm: float) -> str:
    """Format a resistance with four digits, and without a power of ten."""
    return f"{float(f'{resistance_ohm:.4g}'):.0f}" if resistance_ohm >= 1000.0 else f"{resistance_ohm:.4g}"


def _data(calibration: SensorCalibration) -> dict[str, Any]:
    """Return the calibration as plain data."""
    from fingertip.files import round_for_output as rounded

    law = calibration.law
    return {
        "fit": {
            "exponent": rounded(law.exponent), "exponent_uncertainty": rounded(law.exponent_uncertainty),
            "conductance_us": rounded(1e6 * law.conductance_s), "turn_on_n": law.turn_on_n,
            "scatter": rounded(law.scatter), "degrees_of_freedom": law.count - 2,
            "coverage_factor": rounded(law.coverage_factor), "weighings": law.count,
        },
        "offset_v": rounded(calibration.offset_v),
        "ratio_to_typical": rounded(calibration.ratio_to_typical),
        "curve": [
            {"force_n": rounded(point.force_n), "conductance_us": rounded(1e6 * point.conductance_s),
             "voltage_v": rounded(point.voltage_v), "interval_95_n": [rounded(point.low_n), rounded(point.high_n)]}
            for point in calibration.points
        ],
        "values": calibration.changes,
        "set": [f"{path}={value}" for path, value in calibration.changes.items()],
    }  # fmt: skip
