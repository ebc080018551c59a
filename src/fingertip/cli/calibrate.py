"""`fingertip calibrate`: caliper readings of a coupon give the printer's parameters, weighings the sensor's."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fingertip.cli import options
from fingertip.cli.check import format_failures
from fingertip.cli.console import BAD_INPUT, Console
from fingertip.cli.help_page import HelpCommand, HelpGroup
from fingertip.cli.options import command, find_file_issues, load_design
from fingertip.foundation.errors import DesignError, FingertipError, Issue, gather

if TYPE_CHECKING:
    from fingertip.calibration.printer import Calibration
    from fingertip.calibration.sensor import SensorCalibration
    from fingertip.design import Design


calibrate = typer.Typer(
    name="calibrate", help="Turn measurements into parameters.", cls=HelpGroup, no_args_is_help=True
)


@calibrate.command(cls=HelpCommand)
@command
def printer(
    console: Console,
    design: Path = typer.Argument(help="Design file, or bundled design, of which the coupon was printed."),
    readings: Path = typer.Argument(
        help="File of caliper readings, filled in from the one that `fingertip coupon` wrote."
    ),
    out: Path | None = options.CALIBRATED_DESIGN,
    force: bool = options.FORCE_CALIBRATED,
    keep: list[str] | None = typer.Option(None, metavar="TABLE.KEY", help="Leave a parameter as it is; repeatable."),
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Calibrate a design for a printer, from caliper readings of its fit coupon, and check the result.

    Least squares over all readings gives scale and offset: measured = scale * nominal + offset for outer lengths, and
    scale * nominal - offset for inner ones. Each value has a standard uncertainty and a 95 % interval.

    Exit code 0: the calibrated design passes all rules and checks, 1: a check fails, 2: the readings are not usable, or
    a rule refuses the calibrated design.
    """
    from fingertip.cad.verification.verify import check as check_design
    from fingertip.calibration import printer as fit
    from fingertip.calibration.readings import read_readings
    from fingertip.design.files import to_toml
    from fingertip.design.parameters.declaration import suggest_name
    from fingertip.foundation.files import write_file

    kept = keep or []
    remedy = "" if force else "overwrite it with --force"
    issues = list(find_file_issues("--out", out, ".toml", inputs=(design, readings), kept=remedy))
    unknown = (name for name in kept if name not in fit.CALIBRATED)
    issues += (Issue("--keep", f"{name!r} is not calibrated; {suggest_name(name, fit.CALIBRATED)}") for name in unknown)
    with gather(issues):
        loaded = load_design(design, changes, console)
        calibration = fit.calibrate_printer(loaded, read_readings(readings, loaded), kept)
    if issues:
        raise FingertipError(issues)
    data, lines = _data(calibration), _format(calibration)

    def advise() -> str:
        found = fit.find_kept(loaded, calibration, lambda made: all(one.passed for one in check_design(made).checks))
        kept = f"--keep {found} passes, at a printed gap smaller than the design's"
        return kept if found else "change the design as the other messages say, and print its coupon"

    try:
        calibrated = fit.apply_calibration(loaded, calibration.changes, out.stem if out else None)
    except DesignError as error:
        refused = DesignError([*error.issues, Issue("calibration", f"the calibrated design is refused; {advise()}.")])
        if not console.as_json:
            console.write("\n".join(lines))
        console.print_issues(refused, data)
        raise typer.Exit(BAD_INPUT) from None
    checks = check_design(calibrated, progress=console.progress).checks
    lines += format_failures(checks)
    passed = sum(check.passed for check in checks)
    lines.append(f"{passed} of {len(checks)} checks of the calibrated design passed")
    data |= {"passed": passed == len(checks), "checks": [check.to_dict() for check in checks]}
    if out is not None and data["passed"]:
        heading = (
            f"{loaded.name}, calibrated by `fingertip calibrate printer` for one printer, material and setting.\n"
            "Its clearances hold printer.offset_mm: they are wider than the printed gaps."
        )
        write_file(out, to_toml(calibrated, heading).encode())
        data["file"] = out.as_posix()
        again = f"fingertip coupon {shlex.quote(out.as_posix())}"
        lines.append(f"wrote {out}; next: {again}, to see that the fits are right")
    elif not data["passed"]:
        lines.append(f"{f'{out} is not written' if out else 'the calibrated design fails'}; {advise()}")
    console.result(data, "\n".join(lines), data["passed"])


def _format(calibration: Calibration) -> list[str]:
    fit = calibration.fit
    percent, offset = 100.0 * (fit.scale - 1.0), fit.offset_mm
    size, thickness = "large" if percent > 0 else "small", "thick" if offset > 0 else "thin"
    lines = [
        f"Your printer prints {abs(percent):.2f} % too {size}, and solids "
        f"{abs(offset):.2f} mm too {thickness} besides ({abs(offset) / 2:.2f} mm on each side). "
        "The files correct both: leave the slicer as it was set for this coupon.",
        f"scale {fit.scale:.5f} +- {fit.coverage_factor * fit.scale_uncertainty:.5f}, offset {fit.offset_mm:.3f} +- "
        f"{fit.coverage_factor * fit.offset_uncertainty_mm:.3f} mm (95 %, Student's t = {fit.coverage_factor:.2f} of "
        f"{fit.degrees} degrees of freedom, {fit.readings} readings)",
    ]
    lines += (
        f"outlier: reading {outlier.number} of {outlier.name}, {outlier.reading_mm:g} mm, is "
        f"{abs(outlier.deviation_mm):.2f} mm {'more' if outlier.deviation_mm > 0 else 'less'} than the fit; measure it "
        "again, or delete it"
        for outlier in fit.outliers
    )
    columns = max(len(each.name) for each in fit.residuals)
    lines.append(f"{'length':{columns}}  nominal     mean   fitted  difference [mm]")
    lines += (
        f"{each.name:{columns}} {each.nominal_mm:8.3f} {each.mean_mm:8.3f} {each.predicted_mm:8.3f} "
        f"{each.difference_mm:+11.3f}{'  doubtful' if each.is_doubtful else ''}"
        for each in fit.residuals
    )
    lines += (
        f"doubtful: {each.name} is {abs(each.difference_mm):.2f} mm {'more' if each.difference_mm > 0 else 'less'} "
        "than the other lengths let expect; measure it again where coupon.md says, and see that it is not swapped with "
        "another"
        for each in fit.residuals
        if each.is_doubtful
    )
    width = max(len(value.path) for value in calibration.values)
    lines += (
        f"{value.path:{width}} {value.before:8g} -> {value.value:8g} {value.unit:2}  standard uncertainty "
        f"{value.uncertainty:.3f}, 95 % interval {value.low:.3f} to {value.high:.3f}"
        for value in calibration.values
    )
    lines += (f"note: {sentence}" for sentence in calibration.kept)
    return [*lines, " ".join(f"--set {path}={value:g}" for path, value in calibration.changes.items())]


def _data(calibration: Calibration) -> dict[str, Any]:
    from fingertip.foundation.files import round_for_output as rounded

    fit = calibration.fit
    return {
        "fit": {
            "scale": rounded(fit.scale), "scale_uncertainty": rounded(fit.scale_uncertainty),
            "offset_mm": rounded(fit.offset_mm), "offset_uncertainty_mm": rounded(fit.offset_uncertainty_mm),
            "length_error_mm": rounded(fit.length_error_mm), "degrees_of_freedom": fit.degrees,
            "coverage_factor": rounded(fit.coverage_factor), "readings": fit.readings,
        },
        "outliers": [
            {"length": outlier.name, "number": outlier.number, "reading_mm": outlier.reading_mm,
             "deviation_mm": rounded(outlier.deviation_mm)}
            for outlier in fit.outliers
        ],
        "lengths": [
            {"length": each.name, "nominal_mm": each.nominal_mm, "mean_mm": rounded(each.mean_mm),
             "fitted_mm": rounded(each.predicted_mm), "is_doubtful": each.is_doubtful}
            for each in fit.residuals
        ],
        "values": {
            value.path: {"before": value.before, "value": value.value, "unit": value.unit,
                         "standard_uncertainty": rounded(value.uncertainty),
                         "interval_95": [rounded(value.low), rounded(value.high)]}
            for value in calibration.values
        },
        "notes": list(calibration.kept),
        "set": [f"{path}={value:g}" for path, value in calibration.changes.items()],
    }  # fmt: skip


@calibrate.command(cls=HelpCommand)
@command
def sensor(
    console: Console,
    readings: Path = typer.Argument(
        help="CSV file of weighings: a column weight_g or force_n, and one of voltage_v, counts or resistance_ohm."
    ),
    design: Path | None = typer.Argument(
        None, help="Design of the board that took the readings; the default design if left out."
    ),
    out: Path | None = options.CALIBRATED_DESIGN,
    force: bool = options.FORCE_CALIBRATED,
    scale: float | None = typer.Option(None, help="Volts per count, if the readings are counts."),
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Calibrate the force curve of a sensor, from readings under known weights.

    Real sensors of one model differ by factors at the same force. Four weighings or more, over the range of forces that
    matters, give the power law of this one: the conductance follows from each reading and the design's board, and least
    squares of the logarithms give curve and 95 % interval. Readings without load (weight 0) correct the board's offset;
    without one, the command warns.

    Exit code 0: the force curve is calibrated, 2: the weighings are not usable.
    """
    from fingertip.calibration.printer import apply_calibration
    from fingertip.calibration.sensor import calibrate_sensor, list_warnings, read_weighings
    from fingertip.design.files import to_toml
    from fingertip.foundation.files import write_file

    remedy = "" if force else "overwrite it with --force"
    issues = list(find_file_issues("--out", out, ".toml", inputs=(readings, design), kept=remedy))
    with gather(issues):
        loaded = load_design(design, changes, console)
    with gather(issues):
        weighings = read_weighings(readings)
    if issues:
        raise FingertipError(issues)
    calibration = calibrate_sensor(loaded, weighings, scale)
    calibrated = apply_calibration(loaded, calibration.changes)
    data, lines = _sensor_data(calibration), _format_sensor(calibration, calibrated)
    data["warnings"] = list_warnings(weighings)
    console.warn(data["warnings"])
    if out is not None:
        heading = f"{loaded.name}, with the force curve of one sensor on one board, by `fingertip calibrate sensor`."
        write_file(out, to_toml(calibrated, heading).encode())
        data["file"] = out.as_posix()
        lines.append(f"wrote {out}; next: fingertip simulate {shlex.quote(out.as_posix())}")
    console.result(data, "\n".join(lines))


def _format_sensor(calibration: SensorCalibration, calibrated: Design) -> list[str]:
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
    for point in calibration.points:
        ohm = float(f"{1 / point.conductance_s:.4g}")  # four digits, and no power of ten
        interval = f"{point.low_n:.2f} to {point.high_n:.2f} N"
        resistance = f"{ohm:.0f}" if ohm >= 1000.0 else f"{ohm:.4g}"
        lines.append(f"{point.force_n:6.2f} N {resistance:>8} ohm {point.voltage_v:14.3f} V   {interval}")
    lines.append(calibrated.force_curve.describe())
    return [*lines, " ".join(f"--set {path}={value}" for path, value in calibration.changes.items())]


def _sensor_data(calibration: SensorCalibration) -> dict[str, Any]:
    from fingertip.foundation.files import round_for_output as rounded

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
