"""Page of a design or a set as one HTML file, with all styles, scripts and pictures.

Without a script the panels of its tabs stand one below the other; `page.js` makes tabs of them.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from fingertip import __version__
from fingertip.catalogues.output_files import PAGE
from fingertip.design import Design
from fingertip.documents.finger_sheets import FirstScreen, render_start
from fingertip.documents.set_sheets import SetSheets
from fingertip.foundation.tables import read_rows
from fingertip.page import markdown_sheets
from fingertip.page.board_section import draw_response, render_board
from fingertip.page.html import (
    Markup,
    element,
    embed,
    explain,
    fold,
    join,
    list_links,
    read_asset,
    read_viewer_library,
    render_document,
    table,
)
from fingertip.page.markdown_sheets import (
    TICKED_THINGS,
    render_facts,
    render_markdown,
    split_sections,
)
from fingertip.page.model_section import (
    list_items,
    measure_finger,
    render_model,
    render_no_view,
    scene_json,
)
from fingertip.page.pad_section import render_pad
from fingertip.page.parameters_and_checks import (
    render_checks,
    render_parameters,
    render_verdict,
    tell_verdict,
)
from fingertip.page.sources import Sources
from fingertip.page.trial_section import render_trial
from fingertip.pictures.casting_scenes import draw_finger

_MAIL = (
    "Its links lead to files beside it: mail the folder, which fingertip make packs into one "
    "file with --zip."
)
_WORDS = Path(__file__).parent / "assets" / "words.csv"
_BEFORE = "Is this for you?"

Tab = tuple[str, str, tuple[Markup, ...]]
"""Name of a panel, by which links lead to it, its label and its content."""


def render_tabs(
    name: str,
    title: str,
    tabs: Sequence[Tab],
    scripts: Iterable[str] = (),
    banner: str = "",
    end: str = "",
) -> bytes:
    """Render a page of tabs; `banner` stands above all of them, `end` below."""
    meanings = _read_meanings()
    links = (
        element("li", element("a", label, href=f"#{to}", id=f"tab-{to}")) for to, label, _ in tabs
    )
    panels = (
        element(
            "section",
            explain(join(content), meanings),
            id=to,
            class_="panel",
            aria_labelledby=f"tab-{to}",
        )
        for to, _, content in tabs
    )
    body = (
        element("a", "Skip to the content", href="#content", class_="skip"),
        element("header", element("h1", title), banner),
        element("nav", element("ul", *links, id="tabs"), aria_label="sections"),
        element("main", *panels, id="content"),
        element(
            "footer",
            end,
            element("p", f"Made by fingertip {__version__}. This page needs no network. {_MAIL}"),
        ),
    )
    all_scripts = (read_asset("page.js"), *scripts)
    style = read_asset("page.css")

    return render_document(f"{name}: fingertip", body, style, all_scripts, data_design=name)


def _read_meanings() -> dict[str, str]:
    """Read the meaning of each word; two words in a row share it, or have one each."""
    meanings = dict[str, str]()
    for row in read_rows(_WORDS):
        words = row["word"].split(", ")
        own = row["meaning"].split("; ")
        if len(own) != len(words):
            own = [row["meaning"]] * len(words)

        meanings |= dict(zip(words, own, strict=True))

    return {word: meaning for word, meaning in meanings.items() if len(word) > 1}


def render_first_screen(text: str, pictures: Markup, links: Mapping[str, str]) -> Markup:
    """Render the first screen from its Markdown: numbered sections are steps, others boxes."""
    sections = split_sections(text)
    lead = sections.pop("")
    before = sections.pop(_BEFORE)
    steps = [
        element("li", element("h3", heading), render_markdown(sections.pop(heading), links))
        for heading in [*sections]
        if heading[0].isdigit()
    ]
    about = element(
        "div",
        element("div", render_markdown(lead), class_="lead"),
        element("h2", _BEFORE),
        render_markdown(before, links),
        render_facts(sections, links),
        class_="about",
    )

    return join(
        (
            element("div", pictures, about, class_="hero"),
            element("h2", "The next three steps"),
            element("ol", *steps, class_="next"),
        )
    )


def render_finger(picture: bytes, caption: Markup | str) -> Markup:
    image = element(
        "img",
        src=embed(picture, "image/png"),
        alt="The finished finger, from the back and from the palm",
    )
    return element("figure", image, element("figcaption", caption), class_="finger")


ARTICLE_DOI = "10.1109/TMRB.2021.3060032"


@dataclass(frozen=True)
class Prepared:
    """Sections that depend on the design alone: `make` prepares them in parallel."""

    finger: bytes
    """Picture of the finished finger."""
    parameters: Markup
    response: Markup
    pad: Markup | None = None
    """Picture of what the sensor feels; the page draws it where it is not given."""
    trial: Markup | None = None
    """Trial and its detection; the page reads and draws them where they are not given."""


def prepare_page(design: Design) -> Prepared:
    response = draw_response(design) if design.board.has_filter else Markup("")
    return Prepared(draw_finger(design), render_parameters(design), response)


def render_page(sources: Sources, prepared: Prepared | None = None) -> bytes:
    """Render the page of a design. The same files give the same bytes."""
    design = sources.design
    items = list_items(design, sources.files)
    prepared = prepared or prepare_page(design)
    cast = markdown_sheets.render_casting(sources)
    report = sources.report
    links = sources.links
    verdict, kind = tell_verdict(report.checks)
    drawing = markdown_sheets.render_drawing(sources)
    steps = cast.count("data-tick=")
    has_board = design.board.variant != "divider"
    screen = FirstScreen(
        design=design,
        casting=report.casting,
        loads=report.loads,
        size_mm=measure_finger(items),
        files=links,
        steps=steps,
        verdict=verdict,
    )
    picture = render_finger(
        prepared.finger, "The finished finger, computed: from the back, and from the palm."
    )
    tabs = (
        (
            "start",
            "Start",
            (
                render_first_screen(render_start(screen), picture, links),
                element("h2", "In three dimensions", id="model"),
                render_no_view(),
                render_model(items),
            ),
        ),
        (
            "print",
            "Print",
            (
                _title("Print the parts"),
                markdown_sheets.render_printing(sources),
                *((_title("Dimensioned drawing", "drawing"), drawing) if drawing else ()),
            ),
        ),
        ("buy", "Buy", (_title("What to buy"), markdown_sheets.render_shopping(sources))),
        ("cast", "Cast", (_title("Cast the skin", "casting"), cast)),
        (
            "board",
            "Board" if has_board else "Wire",
            (
                _title("The board" if has_board else "The wiring"),
                render_board(sources),
            ),
        ),
        (
            "test",
            "Test",
            (
                _title("Test the sensor and the finished finger"),
                markdown_sheets.render_tests(sources),
            ),
        ),
        (
            "more",
            "More",
            (_title("To look up: nothing to do here"), *_fold_references(sources, prepared)),
        ),
    )
    scripts = (read_viewer_library(), read_asset("viewer.js"), read_asset("board.js"))
    end = join(
        (
            _render_source(),
            element("script", scene_json(items), type="application/json", id="scene"),
        )
    )
    banner = element("a", render_verdict(report.checks), href="#checks") if kind == "failed" else ""

    return render_tabs(
        design.name,
        title=f"Fingertip {design.name}",
        tabs=tabs,
        scripts=scripts,
        banner=banner,
        end=end,
    )


def _fold_references(sources: Sources, prepared: Prepared) -> list[Markup]:
    """Build the folded sections to look something up."""
    design = sources.design
    words = ((element("dfn", row["word"]), row["meaning"]) for row in read_rows(_WORDS))
    basis = markdown_sheets.render_basis(design, sources.report.errors)
    sections = (
        ("basis", "What is simulated and what is measured", basis),
        ("checks", "Checks", render_checks(sources.report.checks)),
        ("parameters", "Parameters", prepared.parameters),
        ("pad", "What the sensor feels", prepared.pad or render_pad(design)),
        ("response", "Response of the board", prepared.response),
        ("trial", "Trial and detection", prepared.trial or render_trial(sources)),
        ("words", "Words", table(("word", "meaning"), words, "words")),
    )
    folded = []
    for name, title, content in sections:
        if content:
            state = "roomy" if name in ("checks", "basis") else ""
            folded.append(fold(title, content, name=name, state=state, level=2))

    return folded


def _title(text: str, name: str = "") -> Markup:
    return element("h2", text, id=name or None)


def _render_source() -> Markup:
    return element(
        "p",
        "After R. A. Romeo, C. Lauretti, C. Gentile, E. Guglielmelli, L. Zollo: Method for "
        "Automatic Slippage "
        "Detection With Tactile Sensors Embedded in Prosthetic Hands. IEEE Transactions on "
        "Medical Robotics and "
        "Bionics 3(2), 485-497, 2021. ",
        element("a", f"doi:{ARTICLE_DOI}", href=f"https://doi.org/{ARTICLE_DOI}"),
        ". The 3D view uses three.js, under the MIT License that stands in this file.",
    )


_TICKED = {"data_ticks": "casting", "data_noun": "days and molds done"}


def render_set_page(
    data: SetSheets,
    pictures: Mapping[str, bytes],
    start: str,
    texts: Iterable[str],
    files: Collection[str],
    failed: Collection[str] = (),
) -> bytes:
    """Render the page of a set, with links to files and with the forms whose checks failed.

    `data` are those of `set_sheets`, `pictures` the PNG of each form by its folder. First screen
    and sheets (overview, casting plan, parts list, acceptance) are Markdown. The same files give
    the same bytes.
    """
    links = {path: quote(path) for path in files}
    fingers = []
    for row in data.fingers:
        link = element("a", row.design, href=f"{quote(row.design)}/{PAGE}")
        fingers.append(render_finger(pictures[row.design], join((f"{row.finger}: ", link))))

    overview, plan, parts, acceptance = (split_sections(text) for text in texts)
    hand, shopping, tests, castings = (
        sections.pop("").partition("\n")[2] for sections in (overview, parts, acceptance, plan)
    )
    common = [path for path in links if path.startswith("board/")]
    board_files = common or [path for path in links if "/board/" in path]
    boards = list_links(board_files, links, "files") if board_files else Markup("")
    tabs: list[Tab] = [
        (
            "start",
            "Start",
            (
                render_first_screen(start, element("div", *fingers, class_="fingers"), links),
                fold("Checks", render_markdown(overview["Checks"], links), state="roomy"),
                fold(
                    "Every step in words",
                    render_markdown(overview["What to do"], links),
                    name="steps",
                ),
            ),
        ),
        (
            "print",
            "Print",
            (element("h2", "Print the parts"), render_markdown(overview["To print"], links)),
        ),
        (
            "buy",
            "Buy",
            (
                element("h2", "What to buy", id="parts-list"),
                render_markdown(shopping, links, **TICKED_THINGS),
            ),
        ),
        (
            "cast",
            "Cast",
            (
                element("h2", "Cast the skins", id="casting-plan"),
                render_markdown(castings, links, **_TICKED),
                *(
                    fold(title, render_markdown(text, links, **_TICKED), state="roomy")
                    for title, text in plan.items()
                ),
            ),
        ),
        (
            "board",
            "Board",
            (element("h2", "Fingers and their boards"), render_markdown(hand, links), boards),
        ),
        (
            "test",
            "Test",
            (
                element("h2", "Test the fingers", id="acceptance"),
                render_markdown(tests, links),
            ),
        ),
    ]
    verdict = f"✗ Checks of {', '.join(failed)} failed: do not print these parts"
    banner = element("p", verdict, class_="verdict failed") if failed else ""

    return render_tabs(data.name, f"Fingers of {data.name}", tabs, banner=banner)
