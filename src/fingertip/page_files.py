"""Writing of the page of a design into its folder."""

from __future__ import annotations

from pathlib import Path

from fingertip.build_files import parts_writer
from fingertip.design import Design
from fingertip.page import PAGE
from fingertip.page.render import render_page
from fingertip.page.sources import read_sources


def write_page(
    design: Design, out: str | Path | None = None, *, force: bool = False
) -> tuple[Path, int, tuple[str, ...]]:
    """Write the page of a design beside its files, `out/NAME/index.html` by default.

    Returns
    -------
    path
        The page.
    size
        Its size [byte].
    remarks
        Sentences on what it does not show, each with the command that makes it.

    Raises
    ------
    OutputError
        If the folder holds no parts of this design, or cannot be written.
    """
    folder = Path("out") / design.name if out is None else Path(out)
    writer = parts_writer(design, folder, force)
    writer.check((PAGE,))
    sources = read_sources(design, folder)
    data = render_page(sources)
    writer.add({PAGE: data})
    return folder / PAGE, len(data), tuple(sources.remarks.values())
