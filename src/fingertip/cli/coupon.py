"""Command `fingertip coupon`: write a small print that shows how a printer makes the fits of a design."""

from __future__ import annotations

from typing import Annotated

import typer

from fingertip.cli.console import CHECK_FAILED, Console, ForceOption, JsonOption, QuietOption, SetOption, command
from fingertip.cli.options import DesignArgument


@command
def coupon(
    design: DesignArgument,
    out: Annotated[str | None, typer.Option(metavar="PATH", help="Output folder; out/NAME/coupon by default.")] = None,
    formats: Annotated[str, typer.Option(help="File formats (stl, 3mf, step), separated by commas.")] = "stl,3mf",
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Write the fit coupon of a design, a file for caliper readings of it, and a page on both.

    The coupon is a frame and a loose piece with the fits of the real parts. It prints in some 20 minutes. `fingertip
    calibrate printer` turns the readings into parameters.
    """
    from fingertip.cli.build import split_names
    from fingertip.cli.check import describe_cause
    from fingertip.cli.load import load_design
    from fingertip.coupon_files import READINGS, write_coupon

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes, console.progress)
    made = write_coupon(loaded, out, formats=split_names(formats), force=force, progress=console.progress)
    lines = [f"{name:12} {mesh.volume() / 1000:8.2f} cm3" for name, mesh in made.meshes.items()]
    failed = [check for check in made.checks if not check.passed]
    for check in failed:
        lines.append(f"FAILED {check.name}: {check.value:g} {check.unit}, must be {check.relation} {check.limit:g}")
        lines.append(describe_cause(check.name))
    passed = len(made.checks) - len(failed)
    lines.append(f"{passed} of {len(made.checks)} checks passed; written to {made.folder}; fill in {READINGS}")
    console.result(made.data(), "\n".join(lines))
    if failed:
        raise typer.Exit(CHECK_FAILED)
