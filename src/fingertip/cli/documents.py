"""Commands that show a design: sheets, drawings, pictures, page and studio."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from fingertip.cli import options
from fingertip.cli.console import Console
from fingertip.cli.options import command, find_file_issues, flag, load_design, refuse

if TYPE_CHECKING:
    from fingertip.design import Design


class _File:
    """File that a command writes: the named one, or one beside the parts."""

    def __init__(
        self,
        design: Design,
        path: Path | None,
        name: str,
        force: bool,
    ) -> None:
        from fingertip.catalogues.output_files import PART_FILES

        self.path = path or PART_FILES.folder(design) / name
        self._writer = None if path else PART_FILES.writer(design, self.path.parent, force)
        if self._writer:
            self._writer.check_addition((name,))

    def write(self, data: bytes) -> None:
        from fingertip.foundation.files import write_file

        if self._writer:
            self._writer.add({self.path.name: data})
        else:
            write_file(self.path, data)


@command
def acceptance(
    console: Console,
    design: Path = options.DESIGN_FILE,
    out: Path | None = typer.Option(
        None, help="Markdown file to write; out/NAME/acceptance.md by default."
    ),
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Write the acceptance sheet: tests of the finished finger, with limits and causes of
    failure.
    """
    from dataclasses import asdict

    from fingertip.catalogues.output_files import ACCEPTANCE
    from fingertip.documents.acceptance import acceptance_sheet, render_acceptance

    refuse(find_file_issues("--out", out, ".md"))
    loaded = load_design(design, changes, console)
    file = _File(loaded, out, ACCEPTANCE, force)
    data = acceptance_sheet(loaded)
    file.write(render_acceptance(data).encode())
    console.result(
        {**asdict(data), "page": str(file.path)}, f"acceptance sheet written to {file.path}"
    )


_MESH_TOLERANCE_MM = 0.01


@command
def sheet(
    console: Console,
    design: Path = options.DESIGN_FILE,
    out: Path | None = typer.Option(
        None, help="Markdown file to write; out/NAME/casting.md by default."
    ),
    material: str | None = options.MATERIAL,
    pictures: bool = flag("Draw a picture of each step, into a folder beside the page."),
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Write the casting sheet: what to buy, and numbered steps from the print to the tested
    finger.
    """
    from dataclasses import asdict

    from fingertip.cad.kernel.mesh import MeshEvaluator
    from fingertip.casting.sheet import casting_sheet
    from fingertip.catalogues.output_files import SHEET, STEPS, STEPS_FOLDER
    from fingertip.documents.finger_sheets import list_steps, render_sheet

    refuse(find_file_issues("--out", out, ".md"))
    loaded = load_design(design, changes, console).with_silicone(material)
    file = _File(loaded, out, SHEET, force)
    step_writer = STEPS.writer(loaded, file.path.parent / STEPS_FOLDER, force, file.path.parent)
    if pictures:
        step_writer.check(())

    data = casting_sheet(loaded, MeshEvaluator(_MESH_TOLERANCE_MM))
    step_pictures: dict[str, bytes] = {}
    if pictures:
        from fingertip.pictures.casting_scenes import draw_steps

        names = [step.picture for step in list_steps(data)]
        step_pictures = draw_steps(loaded, data, names, console.progress)
        step_writer.write(step_pictures)

    picture_files = [f"{STEPS_FOLDER}/{name}" for name in step_pictures]
    file.write(render_sheet(data, picture_files).encode())
    batch = data.batch
    first, second = batch.components
    text = (
        f"mix {batch.a_g:g} g of {first} and {batch.b_g:g} g of {second}; casting sheet "
        f"written to {file.path}"
    )
    console.result({**asdict(data), "page": str(file.path), "pictures": picture_files}, text)


@command
def drawing(
    console: Console,
    design: Path = options.DESIGN_FILE,
    out: Path | None = typer.Option(
        None, metavar="PATH", help="Output folder; out/NAME by default."
    ),
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Draw each printed part to scale with its dimensions, tolerances and sizes to check, as SVG
    and as one PDF.
    """
    from fingertip.tasks.views import write_drawing

    *sheets, pdf = write_drawing(
        load_design(design, changes, console), out, force=force, progress=console.progress
    )
    data = {"drawings": [str(path) for path in (*sheets, pdf)]}
    console.result(data, f"{len(sheets)} sheets drawn to {pdf}, and each to an SVG file")


@command
def picture(
    console: Console,
    design: Path = options.DESIGN_FILE,
    out: Path | None = typer.Option(
        None, help="Output PNG, or SVG with --pad or --measure; in out/NAME by default."
    ),
    pad: bool = flag("Draw what part of a force reaches the sensor, by place and by tilt."),
    measure: bool = flag("Draw where to put the calipers at the joint of your hand."),
    width_px: int = typer.Option(1600, help="Width of the picture, in pixels: 400 to 6000."),
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Draw an exploded view and sections through mold and bone, what the sensor feels, or what to
    measure on a hand.
    """
    from fingertip.catalogues.output_files import EXPLODED_VIEW, HAND_VIEW, PAD_VIEW
    from fingertip.documents.finger_sheets import draw_hand_sizes
    from fingertip.page.pad_section import draw_pad
    from fingertip.page.svg import write_svg
    from fingertip.pictures.design_picture import draw, find_width_issues

    refuse(
        find_file_issues("--out", out, ".svg" if pad or measure else ".png"),
        find_width_issues(width_px),
    )
    loaded = load_design(design, changes, console)
    if measure:
        file = _File(loaded, out, HAND_VIEW, force)
        file.write(draw_hand_sizes(loaded))
    elif pad:
        file = _File(loaded, out, PAD_VIEW, force)
        file.write(write_svg(draw_pad(loaded)))
    else:
        file = _File(loaded, out, EXPLODED_VIEW, force)
        file.write(draw(loaded, width_px, console.progress))

    console.result({"picture": str(file.path)}, f"drawn to {file.path}")


@command
def page(
    console: Console,
    design: Path = options.DESIGN_FILE,
    out: Path | None = typer.Option(
        None, metavar="PATH", help="Folder of the design's files; out/NAME by default."
    ),
    force: bool = options.FORCE,
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Write index.html beside a design's files: 3D view, checks, casting guide, board and trial in
    one offline page.
    """
    from fingertip.tasks.views import write_page

    path, size, remarks = write_page(load_design(design, changes, console), out, force=force)
    for remark in remarks:
        console.progress(f"note: {remark}")

    console.result(
        {"page": str(path), "bytes": size, "remarks": list(remarks)},
        f"page: {path}, {size / 1e6:.1f} MB; open it in a browser, no network is needed",
    )


DEFAULT_PORT = 8350


@command
def studio(
    console: Console,
    design: Path | None = options.OPTIONAL_DESIGN,
    port: int | None = typer.Option(
        None, metavar="N", help=f"Port to listen on; {DEFAULT_PORT} by default, 0 for any free one."
    ),
    no_browser: bool = flag("Print the address and open no browser."),
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Serve a page on this machine where sliders change a design: its parts and checks follow,
    files are downloaded.
    """
    import contextlib
    import webbrowser

    from fingertip.foundation.interruption import INTERRUPTIONS
    from fingertip.studio.server import StudioServer

    loaded = load_design(design, changes, console)

    with StudioServer(loaded, DEFAULT_PORT if port is None else port) as server:
        with contextlib.suppress(*INTERRUPTIONS):  # the way to end it, no failure
            console.result({"url": server.url, "port": server.server_port}, f"studio: {server.url}")
            console.progress("Ctrl-C ends it")
            if not no_browser and not webbrowser.open(server.url):
                console.progress(
                    "no browser was found; open the address above in one of this machine"
                )

            server.serve_forever()

        console.progress("studio ended")
