"""Page of a set of fingers as one HTML file: the hand, what it takes, and the sheets of the set."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any
from urllib.parse import quote

from fingertip.catalogues.output_files import PAGE
from fingertip.page.casting_section import render_list
from fingertip.page.html import Markup, element, fold, join, list_links
from fingertip.page.markdown import render, split_sections
from fingertip.page.tabs import Tab, render_finger, render_first_screen, render_tabs

_TICKED = {"data_ticks": "casting", "data_noun": "stages and castings done"}


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
            fold("Checks and joint", render(overview["Checks and joint"], links), state="roomy"),
            fold("Every step in words", render(overview["What to do"], links), name="steps"),
        )),
        ("print", "Print", (element("h2", "Print the parts"), render(overview["To print"], links))),
        ("buy", "Buy", (
            element("h2", "What to buy", id="parts-list"),
            render_list(shopping, lambda line: "| bench |" in line, links),
        )),
        ("cast", "Cast", (
            element("h2", "Cast the skins", id="casting-plan"), render(castings, links),
            *(fold(title, render(text, links, **_TICKED), state="roomy" if title == "Days" else "")
              for title, text in plan.items()),
        )),
        ("board", "Board", (element("h2", "Fingers and their boards"), render(hand, links), boards)),
        ("test", "Test", (
            element("h2", "Test the fingers", id="acceptance"), render(tests, links),
        )),
    ]  # fmt: skip
    said = f"✗ Checks of {', '.join(failed)} failed: do not print these parts"
    banner = element("p", said, class_="verdict failed") if failed else ""
    return render_tabs(data["name"], f"Fingers of {data['name']}", tabs, banner=banner)
