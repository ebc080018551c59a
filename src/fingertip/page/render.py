"""Page of a design, or of a set, as one HTML file: every style, script, mesh and picture is within it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any
from urllib.parse import quote

from fingertip.catalogues.output_files import PAGE
from fingertip.design import Design
from fingertip.documents.start import render_start
from fingertip.page import casting_section
from fingertip.page.board_section import draw_response, render_board
from fingertip.page.html import Markup, element, fold, join, list_links, read_asset, read_viewer_library
from fingertip.page.markdown import render, split_sections
from fingertip.page.model_section import list_items, measure_finger, render_model, render_no_view, scene_json
from fingertip.page.pad_section import render_pad
from fingertip.page.parameters_and_checks import render_checks, render_parameters, render_verdict, tell_verdict
from fingertip.page.sources import Sources
from fingertip.page.tabs import Tab, render_finger, render_first_screen, render_tabs
from fingertip.page.trial_section import render_trial
from fingertip.pictures.steps.pictures import draw_finger

ARTICLE_DOI = "10.1109/TMRB.2021.3060032"


@dataclass(frozen=True)
class Prepared:
    """Sections that depend on the design alone, and on no file: `make` prepares them while others work."""

    finger: bytes
    """Picture of the finished finger."""
    parameters: Markup
    response: Markup
    pad: Markup | None = None
    """Picture of what the sensor feels; the page draws it where it is not given."""


def prepare_page(design: Design) -> Prepared:
    response = draw_response(design) if design.board.has_filter else Markup("")
    return Prepared(draw_finger(design), render_parameters(design), response)


def render_page(sources: Sources, prepared: Prepared | None = None) -> bytes:
    """Render the page of a design. The same files give the same bytes."""
    design, items = sources.design, list_items(sources.design, sources.files)
    prepared = prepared or prepare_page(design)
    cast = casting_section.render_casting(sources)
    verdict, kind = tell_verdict(sources.report)
    drawing = casting_section.render_drawing(sources)
    steps, has_board = cast.count("data-tick="), design.board.variant != "divider"
    start = render_start(design, sources.report, measure_finger(items), sources.links, steps, verdict)
    picture = render_finger(prepared.finger, "The finished finger, computed: from the back, and from the palm.")
    tabs = (
        ("start", "Start", (
            render_first_screen(start, picture, sources.links),
            element("h2", "In three dimensions", id="model"), render_no_view(), render_model(items),
        )),
        ("print", "Print", (
            _title("Print the parts"), casting_section.render_printing(sources),
            *((_title("Dimensioned drawing", "drawing"), drawing) if drawing else ()),
        )),
        ("buy", "Buy", (_title("What to buy"), casting_section.render_shopping(sources))),
        ("cast", "Cast", (_title("Cast the skin", "casting"), cast)),
        ("board", "Board" if has_board else "Wire", (
            _title("The board" if has_board else "The wiring"), render_board(sources),
        )),
        ("test", "Test", (_title("Test the sensor and the finished finger"), casting_section.render_tests(sources))),
        ("more", "More", tuple(
            fold(title, content, name=name, state="roomy" if name in ("checks", "basis") else "", level=2)
            for name, title, content in (
                ("basis", "What is simulated and what is measured", casting_section.render_basis(design)),
                ("checks", "Checks", render_checks(sources.report)),
                ("parameters", "Parameters", prepared.parameters),
                ("pad", "What the sensor feels", prepared.pad or render_pad(design)),
                ("response", "Response of the board", prepared.response),
                ("trial", "Trial and detection", render_trial(sources)),
            )
            if content
        )),
    )  # fmt: skip
    scripts = (read_viewer_library(), read_asset("viewer.js"), read_asset("board.js"))
    end = join((_render_source(), element("script", scene_json(items), type="application/json", id="scene")))
    banner = element("a", render_verdict(sources.report), href="#checks") if kind == "failed" else ""
    return render_tabs(design.name, f"Fingertip {design.name}", tabs, scripts, banner, end)


def _title(text: str, name: str = "") -> Markup:
    return element("h2", text, id=name or None)


def _render_source() -> Markup:
    return element(
        "p", "After R. A. Romeo, C. Lauretti, C. Gentile, E. Guglielmelli, L. Zollo: Method for Automatic Slippage "
        "Detection With Tactile Sensors Embedded in Prosthetic Hands. IEEE Transactions on Medical Robotics and "
        "Bionics 3(2), 485-497, 2021. ", element("a", f"doi:{ARTICLE_DOI}", href=f"https://doi.org/{ARTICLE_DOI}"),
        ". The 3D view uses three.js, under the MIT License that stands in this file.",
    )  # fmt: skip


_TICKED = {"data_ticks": "casting", "data_noun": "days and molds done"}
_AT_HAND = {"data_ticks": "shopping", "data_noun": "things at hand"}


def render_set_page(
    data: Mapping[str, Any],
    pictures: Mapping[str, bytes],
    start: str,
    sheets: Iterable[str],
    files: Collection[str],
    failed: Collection[str] = (),
) -> bytes:
    """Render the page of a set, with links to files and with the forms whose checks failed.

    `data` are those of `set_data`, `pictures` the PNG of each form by its folder. First screen and sheets (overview,
    casting plan, parts list, acceptance) are Markdown. The same files give the same bytes.
    """
    links = {path: quote(path) for path in files}
    drawn = [
        render_finger(
            pictures[row["design"]],
            join((f"{row['finger']}: ", element("a", row["design"], href=f"{quote(row['design'])}/{PAGE}"))),
        )
        for row in data["fingers"]
    ]
    overview, plan, parts, acceptance = (split_sections(text) for text in sheets)
    hand, shopping, tests, castings = (each.pop("").partition("\n")[2] for each in (overview, parts, acceptance, plan))
    shown = [path for path in links if path.startswith("board/")] or [path for path in links if "/board/" in path]
    boards = list_links(shown, links, "files") if shown else Markup("")
    tabs: list[Tab] = [
        ("start", "Start", (
            render_first_screen(start, element("div", *drawn, class_="fingers"), links),
            fold("Checks", render(overview["Checks"], links), state="roomy"),
            fold("Every step in words", render(overview["What to do"], links), name="steps"),
        )),
        ("print", "Print", (element("h2", "Print the parts"), render(overview["To print"], links))),
        ("buy", "Buy", (
            element("h2", "What to buy", id="parts-list"), render(shopping, links, **_AT_HAND),
        )),
        ("cast", "Cast", (
            element("h2", "Cast the skins", id="casting-plan"), render(castings, links, **_TICKED),
            *(fold(title, render(text, links, **_TICKED), state="roomy") for title, text in plan.items()),
        )),
        ("board", "Board", (element("h2", "Fingers and their boards"), render(hand, links), boards)),
        ("test", "Test", (
            element("h2", "Test the fingers", id="acceptance"), render(tests, links),
        )),
    ]  # fmt: skip
    said = f"✗ Checks of {', '.join(failed)} failed: do not print these parts"
    banner = element("p", said, class_="verdict failed") if failed else ""
    return render_tabs(data["name"], f"Fingers of {data['name']}", tabs, banner=banner)
