"""Page of a set of fingers as one HTML file: the hand, and the sheets of the set."""

from __future__ import annotations

from collections.abc import Mapping

from fingertip.catalogues.output_files import PAGE
from fingertip.foundation.version import __version__
from fingertip.page import markdown
from fingertip.page.html import element, embed, read_asset, render_document


def render_set_page(name: str, pictures: Mapping[str, tuple[str, bytes]], sheets: Mapping[str, str]) -> bytes:
    """Render the page of a set. The same files give the same bytes.

    Parameters
    ----------
    name
        Name of the set.
    pictures
        Folder of each form -> its fingers, and its picture (PNG).
    sheets
        Title of each section -> its Markdown, whose own title is left out.
    """
    links = (element("li", element("a", title, href=f"#{_anchor(title)}")) for title in ("The hand", *sheets))
    drawn = (
        element(
            "figure",
            element("img", src=embed(data, "image/png"), alt=f"{fingers}: {form} in parts", width="440"),
            element("figcaption", f"{fingers}: ", element("a", form, href=f"{form}/{PAGE}")),
        )
        for form, (fingers, data) in pictures.items()
    )
    sections = [
        element("section", element("h2", "The hand", id=_anchor("The hand")), element("div", *drawn, class_="facts")),
        *(
            element("section", element("h2", title, id=_anchor(title)), markdown.render(_without_title(text)))
            for title, text in sheets.items()
        ),
    ]
    body = (
        element("a", "Skip to the content", href="#content", class_="skip"),
        element("header", element("h1", f"Fingers of {name}"),
                element("p", "A set of sensorised prosthetic fingertips: parts, casting plan, parts list, acceptance.",
                        class_="lead")),
        element("nav", element("ul", *links), aria_label="sections"),
        element("main", *sections, id="content"),
        element("footer", element("p", f"fingertip {__version__}")),
    )  # fmt: skip
    return render_document(f"{name}: fingertip", body, read_asset("page.css"), ())


def _anchor(title: str) -> str:
    return title.lower().replace(" ", "-")


def _without_title(text: str) -> str:
    first, _, rest = text.partition("\n")
    return rest if first.startswith("# ") else text
