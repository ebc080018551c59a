"""`fingertip build`: a design in, printable parts out."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import CHECK_FAILED, Console, JsonOption, QuietOption, SetOption, command


@command
def build(
    design: Annotated[Path, typer.Argument(help="Design file, such as params/fsr400.toml.")],
    out: Annotated[
        str | None, typer.Option(metavar="PATH", help="Folder to write to; out/<design name> if left out.")
    ] = None,
    parts: Annotated[str | None, typer.Option(help="Which parts, separated by commas; all if left out.")] = None,
    formats: Annotated[str, typer.Option(help="Which formats, separated by commas.")] = "stl,3mf,step",
    tolerance_mm: Annotated[float, typer.Option(help="Most a facet strays from the exact surface.")] = 0.01,
    material: Annotated[
        str, typer.Option(help="Silicone of the casting sheet, as in `fingertip sheet`.")
    ] = "addition_40a",
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Build bone, skin and mold as STL, 3MF and STEP, check them, and write a report and the casting sheet."""
    from fingertip.build_files import build as build_parts
    from fingertip.cli.load import load_design

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes)
    result = build_parts(
        loaded,
        out,
        parts=None if parts is None else _words(parts),
        formats=_words(formats),
        tolerance_mm=tolerance_mm,
        material=material,
        progress=console.progress,
    )
    lines = [
        f"{built.part.name:12} {built.mesh.volume() / 1000:8.2f} cm3   {', '.join(built.files.values())}"
        for built in result.parts
    ]
    failed = [check for check in result.checks if not check.passed]
    lines += [f"FAILED {c.name}: {c.value:g} {c.unit}, limit {c.limit:g}" for c in failed]
    lines.append(
        f"{len(result.checks) - len(failed)} of {len(result.checks)} checks passed; written to {result.folder}"
    )
    data = result.report() | {"folder": str(result.folder), "removed": list(result.removed)}
    console.result(data, "\n".join(lines))
    if failed:
        raise typer.Exit(CHECK_FAILED)


def _words(text: str) -> list[str]:
    return [word.strip() for word in text.split(",") if word.strip()]
