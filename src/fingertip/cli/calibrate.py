"""`fingertip calibrate`: a printer's parameters from calipers, a sensor's from weights."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fingertip.cli import options
from fingertip.cli.console import Console
from fingertip.cli.help_page import HelpCommand, HelpGroup
from fingertip.cli.options import command, find_file_issues, load_design
from fingertip.foundation.errors import FingertipError, gather, raise_issues

if TYPE_CHECKING:
    from fingertip.calibration.sensor import SensorCalibration
    from fingertip.design import Design


calibrate = typer.Typer(
    name="calibrate",
    help="Turn measurements into parameters.",
    cls=HelpGroup,
    no_args_is_help=True,
)


@calibrate.command(cls=HelpCommand)
@command
def printer(
    console: Console,
    design: Path = typer.Argument(
        parser=options.parse_design,
        help="Design file, or bundled design, whose parts were printed.",
    ),
    half_thickness_mm: float = typer.Option(
        metavar="MM",
        help="Thickness of mold_palmar beside its hollow, between the belts, from its flat face "
        "to the outside.",
    ),
    plate_width_mm: float | None = typer.Option(
        None,
        metavar="MM",
        help="Width of the core's plate from lip to lip, beside the seats of the band.",
    ),
    out: Path | None = options.CALIBRATED_DESIGN,
    force: bool = options.FORCE_CALIBRATED,
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Find the over- or undersize of a printer from one caliper reading of the cup, and one of the
    core for its scale.

    The answer is the lines to put into the design, with the standard uncertainty that calipers
    leave. A part is measured after printing as it was sliced from these files; measure above the
    first layers, which bulge.

    Exit code 0: the calibrated design passes all rules, 2: the readings are not usable, or a rule
    refuses the design.
    """
    from fingertip.calibration.printer import apply_calibration, calibrate_printer
    from fingertip.design.design_file import to_toml
    from fingertip.foundation.files import round_for_output, write_file

    remedy = "" if force else "overwrite it with --force"
    issues = list(find_file_issues("--out", out, ".toml", inputs=(design,), kept=remedy))

    with gather(issues):
        loaded = load_design(design, changes, console)
        calibration = calibrate_printer(loaded, half_thickness_mm, plate_width_mm)
        calibrated = apply_calibration(loaded, calibration.changes, out.stem if out else None)

    raise_issues(FingertipError, issues)
    knowledge = "known" if plate_width_mm else "assumed"
    figures = ("scale", "scale_uncertainty", "offset_mm", "offset_uncertainty_mm")
    data: dict[str, Any] = {name: round_for_output(getattr(calibration, name)) for name in figures}
    data |= {
        "values": dict(calibration.changes),
        "set": [f"{path}={value:g}" for path, value in calibration.changes.items()],
    }
    offset = calibration.offset_mm
    percent = 100.0 * (calibration.scale - 1.0)
    scale_error = ""
    if percent:
        scale_error = f", and {abs(percent):.2f} % too {'large' if percent > 0 else 'small'}"

    lines = [
        f"Your printer prints solids {abs(offset):.2f} mm too {'thick' if offset > 0 else 'thin'} "
        f"(+- {calibration.offset_uncertainty_mm:.2f} mm, standard uncertainty){scale_error}; "
        f"the scale is {knowledge} within {100 * calibration.scale_uncertainty:.1f} %.",
        "Write into the design, in place of the lines of these names:",
        *(f"{path} = {value:g}" for path, value in calibration.changes.items()),
        " ".join(f"--set {change}" for change in data["set"]),
    ]

    if out is not None:
        heading = (
            f"{loaded.name}, calibrated by `fingertip calibrate printer` for one printer, "
            "material and setting."
        )
        write_file(out, to_toml(calibrated, heading).encode())
        data["file"] = out.as_posix()
        lines.append(f"wrote {out}; next: fingertip make {shlex.quote(out.as_posix())}")

    console.result(data, "\n".join(lines))


@calibrate.command(cls=HelpCommand)
@command
def sensor(
    console: Console,
    readings: Path = typer.Argument(
        help="CSV file of weighings: a column weight_g or force_n, and one of voltage_v, counts "
        "or resistance_ohm."
    ),
    design: Path | None = typer.Argument(
        None,
        parser=options.parse_design,
        help="Design of the board that took the readings; the default design if left out.",
    ),
    out: Path | None = options.CALIBRATED_DESIGN,
    force: bool = options.FORCE_CALIBRATED,
    scale: float | None = typer.Option(None, help="Volts per count, if the readings are counts."),
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Calibrate the force curve of a sensor, from readings under known weights.

    Real sensors of one model differ by factors at the same force. Four weighings or more, over the
    range of forces that matters, give the power law of this one: the conductance follows from each
    reading and the design's board, and least squares of the logarithms give curve and 95 %
    interval. Readings without load (weight 0) correct the board's offset; without one, the command
    warns.

    Exit code 0: the force curve is calibrated, 2: the weighings are not usable.
    """
    from fingertip.calibration.printer import apply_calibration
    from fingertip.calibration.sensor import calibrate_sensor, list_warnings, read_weighings
    from fingertip.design.design_file import to_toml
    from fingertip.foundation.files import write_file

    remedy = "" if force else "overwrite it with --force"
    issues = list(find_file_issues("--out", out, ".toml", inputs=(readings, design), kept=remedy))
    with gather(issues):
        loaded = load_design(design, changes, console)

    with gather(issues):
        weighings = read_weighings(readings)

    raise_issues(FingertipError, issues)
    calibration = calibrate_sensor(loaded, weighings, scale)
    calibrated = apply_calibration(loaded, calibration.changes)
    data = _sensor_data(calibration)
    lines = _format_sensor(calibration, calibrated)
    data["warnings"] = list_warnings(weighings, calibration)
    console.warn(data["warnings"])

    if out is not None:
        heading = (
            f"{loaded.name}, with the force curve of one sensor on one board, by `fingertip "
            "calibrate sensor`."
        )
        write_file(out, to_toml(calibrated, heading).encode())
        data["file"] = out.as_posix()
        lines.append(f"wrote {out}; next: fingertip simulate {shlex.quote(out.as_posix())}")

    console.result(data, "\n".join(lines))


def _format_sensor(calibration: SensorCalibration, calibrated: Design) -> list[str]:
    law = calibration.law
    half = law.coverage_factor * law.exponent_uncertainty
    lines = [
        f"exponent {law.exponent:.3f} +- {half:.3f}, conductance {1e6 * law.conductance_s:.4g} uS "
        "1 N above the "
        f"turn-on at {law.turn_on_n:g} N, scatter {100 * law.scatter:.1f} % (95 %, Student's t = "
        f"{law.coverage_factor:.2f} of {law.count - 2} degrees of freedom, {law.count} weighings)",
        f"{calibration.ratio_to_typical:.2g} times the conductance of the typical sensor",
    ]

    if calibration.offset_v:
        lines.append(
            f"offset of the board without load: {1000 * calibration.offset_v:+.1f} mV, taken off "
            "the readings"
        )

    lines.append(
        f"{'force':>8} {'sensor':>12} {'tactile voltage':>16}   95 % interval of a force read off "
        "it"
    )
    for point in calibration.points:
        ohm = float(f"{1 / point.conductance_s:.4g}")  # four digits, and no power of ten
        interval = f"{point.low_n:.2f} to {point.high_n:.2f} N"
        resistance = f"{ohm:.0f}" if ohm >= 1000.0 else f"{ohm:.4g}"
        lines.append(
            f"{point.force_n:6.2f} N {resistance:>8} ohm {point.voltage_v:14.3f} V   {interval}"
        )

    lines.append(calibrated.force_curve.describe(calibrated.sensor.model))
    return [
        *lines,
        " ".join(f"--set {path}={value}" for path, value in calibration.changes.items()),
    ]


def _sensor_data(calibration: SensorCalibration) -> dict[str, Any]:
    from fingertip.foundation.files import round_for_output as rounded

    law = calibration.law
    return {
        "fit": {
            "exponent": rounded(law.exponent),
            "exponent_uncertainty": rounded(law.exponent_uncertainty),
            "conductance_us": rounded(1e6 * law.conductance_s),
            "turn_on_n": law.turn_on_n,
            "scatter": rounded(law.scatter),
            "degrees_of_freedom": law.count - 2,
            "coverage_factor": rounded(law.coverage_factor),
            "weighings": law.count,
        },
        "offset_v": rounded(calibration.offset_v),
        "ratio_to_typical": rounded(calibration.ratio_to_typical),
        "curve": [
            {
                "force_n": rounded(point.force_n),
                "conductance_us": rounded(1e6 * point.conductance_s),
                "voltage_v": rounded(point.voltage_v),
                "interval_95_n": [rounded(point.low_n), rounded(point.high_n)],
            }
            for point in calibration.points
        ],
        "values": calibration.changes,
        "set": [f"{path}={value}" for path, value in calibration.changes.items()],
    }
