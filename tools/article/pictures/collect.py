"""All figures of the article, of one design."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from fingertip.design import Design
from fingertip.documents.template import WIDTH, lay_out_page, render_text
from fingertip.page.block_diagram_svg import draw_block_diagram, list_blocks
from fingertip.page.svg import write_svg
from tools.article.boards import with_article_board
from tools.article.pictures.figure import Figure, Statement
from tools.article.pictures.grasps import draw_grasps
from tools.article.pictures.spectra import draw_spectra
from tools.article.pictures.trials import draw_trials
from tools.article.pictures.windows import draw_windows
from tools.article.protocol import with_threshold

TEMPLATE = Path(__file__).parents[1] / "figures.md"


def draw_figures(design: Design) -> list[Figure]:
    """Draw the figures with the finger of a design, on the article's board and converter."""
    article = with_threshold(with_article_board(design), "analog")
    return [
        draw_blocks(article),
        draw_spectra(article),
        draw_windows(article),
        *draw_trials(article),
        *draw_grasps(article),
    ]


def draw_blocks(design: Design) -> Figure:
    """Draw figure 1, the block diagram of the board."""
    blocks = list_blocks(design)
    titles = [block.title for block in blocks]
    filters = [title for title in titles if title.startswith("High-pass")]
    steps = [*filters, "Rectifier", "Envelope", "Threshold"]
    software = [block.title for block in blocks if block.is_software]
    statements = (
        Statement(
            "filter network, half-wave rectification, envelope, binary ON-OFF",
            ", ".join(steps),
            len(filters) == 2 and steps == [title for title in titles if title in steps],
        ),
        Statement(
            "the last step is software, all others are a circuit",
            f"behind the board: {', '.join(software)}",
            software == ["Converter", "Window", "Threshold"],
        ),
    )
    return Figure(
        "article_blocks.svg",
        "Fig. 1: the stages",
        "Stages of the article's board from the sensor to ON and OFF, drawn from its circuit. The "
        "page of a design shows those of its own board.",
        write_svg(draw_block_diagram(design)),
        statements,
    )


def render_figures(figures: Iterable[Mapping[str, Any]]) -> str:
    """Write the section of the figures, from their data."""
    return render_text(TEMPLATE.read_text(encoding="utf-8"), figures=figures)


def as_files(figures: Iterable[Figure]) -> dict[str, bytes]:
    """Return file name -> content: the pictures, and a page of them."""
    drawn = list(figures)
    text = lay_out_page(render_figures(one.as_data() for one in drawn), WIDTH)
    return {**{one.file: one.picture for one in drawn}, "figures.md": text.encode()}
