"""`fingertip sheet`: what to weigh, buy, print and wait for to cast a design."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import Console, JsonOption, QuietOption, SetOption, command


@command
def sheet(
    design: Annotated[Path, typer.Argument(help="Design file, such as params/fsr400.toml.")],
    out: Annotated[Path | None, typer.Option(help="Page to write; out/<design name>/casting.md if left out.")] = None,
    material: Annotated[
        str, typer.Option(help="Silicone: addition_40a, condensation_40a, sylgard_184.")
    ] = "addition_40a",
    slicer: Annotated[bool, typer.Option("--slicer", help="Ask PrusaSlicer for printing times and material.")] = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Write the casting sheet: silicone and its parts A and B, steps, warnings, bill of materials, printing."""
    from fingertip.cad.kernel.mesh import MeshEvaluator
    from fingertip.cad.printing import print_orientations
    from fingertip.casting import markdown
    from fingertip.casting import quantities
    from fingertip.casting.materials import silicone
    from fingertip.casting.sheet import figures
    from fingertip.casting.slicer import HOW_TO_INSTALL, PrintEstimate, find_slicer, slice_part
    from fingertip.cli.load import load_design
    from fingertip.files import write_file

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes)
    card = silicone(material)
    prints: dict[str, PrintEstimate] | None = None
    program = find_slicer() if slicer else None
    if slicer and program is None:
        console.progress(f"no printing times: PrusaSlicer is not installed ({HOW_TO_INSTALL})")
    if program is not None:
        from fingertip.cad.verification.verify import verify

        lies = print_orientations(loaded)
        files = verify(loaded, lies, ("stl",), MeshEvaluator(0.02)).contents
        prints = {}
        for name, how in lies.items():
            console.progress(f"slicing {name}")
            prints[name] = slice_part(program, name, files[f"{name}.stl"], how)
    data = figures(loaded, measure_volumes(loaded, MeshEvaluator(0.01)), card, prints)
    path = out or Path("out") / loaded.name / "casting.md"
    write_file(path, markdown.page(data).encode())
    batch = data["batch"]
    text = f"{batch['a_g']:g} g of A and {batch['b_g']:g} g of B; written to {path}"
    console.result({**data, "page": str(path)}, text)
