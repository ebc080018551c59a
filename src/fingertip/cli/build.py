"""Command `fingertip build`: make the printable parts of a design."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import CHECK_FAILED, Console, JsonOption, QuietOption, SetOption, command


@command
def build(
    design: Annotated[Path, typer.Argument(help="Design file, such as params/fsr400.toml.")],
    out: Annotated[str | None, typer.Option(metavar="PATH", help="Output folder; out/NAME by default.")] = None,
    parts: Annotated[
        str | None, typer.Option(help="Parts (bone, skin, ...), separated by commas; all by default.")
    ] = None,
    formats: Annotated[str, typer.Option(help="File formats (stl, 3mf, step), separated by commas.")] = "stl,3mf,step",
    tolerance_mm: Annotated[
        float, typer.Option(help="Largest distance of a facet from the exact surface, in mm.")
    ] = 0.01,
    material: Annotated[
        str, typer.Option(help="Silicone of the casting sheet: addition_40a, condensation_40a or sylgard_184.")
    ] = "addition_40a",
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Build bone, skin and mold as STL, 3MF and STEP files, check them, and write a report and a casting sheet."""
    from fingertip.build_files import build as build_parts
    from fingertip.cli.load import load_design

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes, console.progress)
    result = build_parts(
        loaded,
        out,
        parts=None if parts is None else _split_names(parts),
        formats=_split_names(formats),
        tolerance_mm=tolerance_mm,
        material=material,
        progress=console.progress,
    )
    lines = [
        f"{built.part.name:12} {built.mesh.volume() / 1000:8.2f} cm3   {', '.join(built.files.values())}"
        for built in result.parts
    ]
    failed = [check for check in result.checks if not check.passed]
    lines += [f"FAILED {c.name}: {c.value:g} {c.unit}, must be {c.relation} {c.limit:g}" for c in failed]
    lines.append(
        f"{len(result.checks) - len(failed)} of {len(result.checks)} checks passed; written to {result.folder}"
    )
    data = result.report() | {"folder": str(result.folder), "removed": list(result.removed)}
    console.result(data, "\n".join(lines))
    if failed:
        raise typer.Exit(CHECK_FAILED)


def _split_names(text: str) -> list[str]:
    """Split a comma-separated option into names."""
    return [name.strip() for name in text.split(",") if name.strip()]
