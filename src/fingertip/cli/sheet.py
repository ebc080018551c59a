"""`fingertip sheet`: write the casting sheet of a design."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import Console, ForceOption, JsonOption, QuietOption, SetOption, command
from fingertip.cli.options import DesignArgument, MaterialOption
from fingertip.cli.output_files import find_file_issues

_MESH_TOLERANCE_MM = 0.01
_SLICED_MESH_TOLERANCE_MM = 0.02


@command
def sheet(
    design: DesignArgument,
    out: Annotated[Path | None, typer.Option(help="Markdown file to write; out/NAME/casting.md by default.")] = None,
    material: MaterialOption = None,
    slicer: Annotated[
        bool, typer.Option("--slicer", help="Estimate print time and volume on a filament printer with PrusaSlicer.")
    ] = False,
    pictures: Annotated[
        bool, typer.Option("--pictures", help="Draw a picture of each step, into a folder beside the page.")
    ] = False,
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Write the casting sheet: silicone quantities, warnings, procedure, print orientations and bill of materials."""
    from fingertip.build_files import parts_writer, steps_writer
    from fingertip.build_result import SHEET, STEPS_FOLDER
    from fingertip.cad.kernel.mesh import MeshEvaluator
    from fingertip.cad.printing.orientations import print_orientations
    from fingertip.cad.printing.plates import FDM
    from fingertip.cad.strength.assess import assess_strength
    from fingertip.cad.verification.check import list_warnings
    from fingertip.cad.verification.strength import check_strength
    from fingertip.casting.markdown import render_sheet, steps
    from fingertip.casting.quantities import measure_volumes
    from fingertip.casting.sheet import casting_sheet_data
    from fingertip.casting.slicer import HOW_TO_INSTALL, PrintEstimate, find_slicer, slice_plate
    from fingertip.cli.load import load_design
    from fingertip.design.silicone import replace_silicone, select_silicone
    from fingertip.errors import OutputError
    from fingertip.files import write_file

    console = Console(as_json, quiet)
    if issues := list(find_file_issues("--out", out, ".md")):
        raise OutputError(issues)
    loaded, _ = load_design(design, changes, console.progress)
    loaded = replace_silicone(loaded, material)
    silicone = select_silicone(loaded)
    path = out or Path("out") / loaded.name / SHEET
    if out is None:
        parts_writer(loaded, path.parent, force).check_addition((SHEET,))
    if pictures:
        steps_writer(loaded, path.parent, force).check(())
    prints: dict[str, PrintEstimate] | None = None
    program = find_slicer() if slicer else None
    if slicer and program is None:
        console.progress(f"no print times: PrusaSlicer is not installed ({HOW_TO_INSTALL})")
    if program is not None:
        from fingertip.cad.verification.verify import verify

        files = verify(loaded, print_orientations(loaded), ("3mf",), MeshEvaluator(_SLICED_MESH_TOLERANCE_MM)).prints
        prints = {}
        for file in (name for name in files.plates if name.startswith(f"plate_{FDM.name}")):
            name = file.removesuffix(".3mf")
            console.progress(f"slicing {name}")
            prints[name] = slice_plate(program, name, files.contents[file], loaded)
    volumes = measure_volumes(loaded, MeshEvaluator(_MESH_TOLERANCE_MM))
    strength = check_strength(loaded, assess_strength(loaded, MeshEvaluator(_MESH_TOLERANCE_MM)))
    data = casting_sheet_data(loaded, volumes, silicone, prints, list_warnings(strength))
    drawn: dict[str, bytes] = {}
    if pictures:
        from fingertip.view.steps.pictures import draw_steps

        drawn = draw_steps(loaded, data, steps(data), console.progress)
        steps_writer(loaded, path.parent, force).write(drawn)
    page = render_sheet(data, [f"{STEPS_FOLDER}/{name}" for name in drawn]).encode()
    if out is None:
        parts_writer(loaded, path.parent, force).add({SHEET: page})
    else:
        write_file(out, page)
    batch = data["batch"]
    first, second = silicone.components
    text = f"mix {batch['a_g']:g} g of {first} and {batch['b_g']:g} g of {second}; casting sheet written to {path}"
    console.result({**data, "page": str(path), "pictures": [f"{STEPS_FOLDER}/{name}" for name in drawn]}, text)
