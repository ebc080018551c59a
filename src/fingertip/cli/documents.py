"""`fingertip acceptance`: write the acceptance sheet of a finger."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import Console, ForceOption, JsonOption, QuietOption, SetOption, command
from fingertip.cli.options import DesignArgument, MaterialOption, find_file_issues


@command
def acceptance(
    design: DesignArgument,
    out: Annotated[Path | None, typer.Option(help="Markdown file to write; out/NAME/acceptance.md by default.")] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Write the acceptance sheet: tests of the sensor and of the finished finger, with limits and causes of failure."""
    from fingertip.cli.options import load_design
    from fingertip.documents.acceptance import acceptance_data, render_acceptance
    from fingertip.foundation.errors import OutputError
    from fingertip.foundation.files import write_file
    from fingertip.tasks.build import parts_writer
    from fingertip.tasks.make import ACCEPTANCE, simulate_and_detect

    console = Console(as_json, quiet)
    if issues := list(find_file_issues("--out", out, ".md")):
        raise OutputError(issues)
    loaded, _ = load_design(design, changes, console.progress)
    path = out or Path("out") / loaded.name / ACCEPTANCE
    if out is None:
        parts_writer(loaded, path.parent, force).check_addition((ACCEPTANCE,))
    _, found = simulate_and_detect(loaded, console.progress)
    data = acceptance_data(loaded, found.detection)
    page = render_acceptance(data).encode()
    if out is None:
        parts_writer(loaded, path.parent, force).add({ACCEPTANCE: page})
    else:
        write_file(out, page)
    console.result({**data, "page": str(path)}, f"acceptance sheet written to {path}")


# `fingertip sheet`: write the casting sheet of a design.


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
    from fingertip.cad.kernel.mesh import MeshEvaluator
    from fingertip.cad.printing.orientations import print_orientations
    from fingertip.cad.printing.print_files import FDM
    from fingertip.cad.report import SHEET, STEPS_FOLDER
    from fingertip.cad.verification.bone import check_strength
    from fingertip.cad.verification.check import list_warnings
    from fingertip.cad.verification.strength import assess_strength
    from fingertip.casting.quantities import measure_volumes
    from fingertip.casting.slicer import HOW_TO_INSTALL, PrintEstimate, find_slicer, slice_plate
    from fingertip.cli.options import load_design
    from fingertip.documents.casting.markdown import render_sheet, steps
    from fingertip.documents.casting.sheet import casting_sheet_data
    from fingertip.foundation.errors import OutputError
    from fingertip.foundation.files import write_file
    from fingertip.tasks.build import parts_writer, steps_writer

    console = Console(as_json, quiet)
    if issues := list(find_file_issues("--out", out, ".md")):
        raise OutputError(issues)
    loaded, _ = load_design(design, changes, console.progress)
    loaded = loaded.with_silicone(material)
    silicone = loaded.silicone.material
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
        from fingertip.pictures.steps.pictures import draw_steps

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


# Command `fingertip drawing`: dimensioned drawings of the printed parts.


@command
def drawing(
    design: DesignArgument,
    out: Annotated[Path | None, typer.Option(metavar="PATH", help="Output folder; out/NAME by default.")] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Draw each printed part to scale with its dimensions, tolerances and sizes to check, as SVG and as one PDF."""
    from fingertip.cli.options import load_design
    from fingertip.pictures.drawing.draw import draw_files, file_names, require_packages
    from fingertip.tasks.build import parts_writer

    console = Console(as_json, quiet)
    require_packages("fingertip drawing")
    loaded, _ = load_design(design, changes, console.progress)
    folder = out or Path("out") / loaded.name
    writer = parts_writer(loaded, folder, force)
    writer.check_addition(file_names(loaded))
    files = draw_files(loaded, console.progress)
    writer.add(files)
    paths = [str(folder / name) for name in files]
    console.result({"drawings": paths}, f"{len(files) - 1} sheets drawn to {paths[-1]}, and each to an SVG file")


# Command `fingertip picture`: draw a design before it is printed.


MIN_WIDTH_PX = 400
MAX_WIDTH_PX = 6000


@command
def picture(
    design: DesignArgument,
    out: Annotated[
        Path | None, typer.Option(help="Output PNG; out/NAME/exploded.png or filling.png by default.")
    ] = None,
    filling: Annotated[
        bool,
        typer.Option("--filling", help="Draw when the silicone arrives where, with vents and last points."),
    ] = False,
    width_px: Annotated[int, typer.Option(help="Width of the picture, in pixels: 400 to 6000.")] = 1600,
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Draw an exploded view of the fingertip and a section through the closed mold, or how the mold fills."""
    from fingertip.cli.options import load_design
    from fingertip.foundation.errors import Issue, OutputError
    from fingertip.foundation.files import write_file
    from fingertip.pictures.filling import draw_mold_filling
    from fingertip.pictures.picture import draw
    from fingertip.tasks.build import parts_writer

    console = Console(as_json, quiet)
    issues = list(find_file_issues("--out", out, ".png"))
    if not MIN_WIDTH_PX <= width_px <= MAX_WIDTH_PX:
        issues.append(Issue("--width-px", f"{width_px} is out of range; choose {MIN_WIDTH_PX} to {MAX_WIDTH_PX}."))
    if issues:
        raise OutputError(issues)
    loaded, _ = load_design(design, changes, console.progress)
    path = out or Path("out") / loaded.name / ("filling.png" if filling else "exploded.png")
    if out is None:
        parts_writer(loaded, path.parent, force).check_addition((path.name,))
    data = draw_mold_filling(loaded) if filling else draw(loaded, width_px, console.progress)
    if out is None:
        parts_writer(loaded, path.parent, force).add({path.name: data})
    else:
        write_file(out, data)
    console.result({"picture": str(path)}, f"drawn to {path}")


# Command `fingertip page`: one page that shows everything of a design.


@command
def page(
    design: DesignArgument,
    out: Annotated[
        Path | None, typer.Option(metavar="PATH", help="Folder of the design's files; out/NAME by default.")
    ] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Write index.html beside a design's files: 3D view, checks, casting guide, board and trial in one offline page."""
    from fingertip.cli.options import load_design
    from fingertip.tasks.page import write_page

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes, console.progress)
    path, size, remarks = write_page(loaded, out, force=force)
    for remark in remarks:
        console.progress(f"note: {remark}")
    console.result(
        {"page": str(path), "bytes": size, "remarks": list(remarks)},
        f"page: {path}, {size / 1e6:.1f} MB; open it in a browser, no network is needed",
    )
