"""Bill of materials of a board as a table whose lines name their parts.

`board.js` adds a check box for what is placed and a button that highlights the parts of a line on the pictures of the
board. Without scripts it is a plain table.
"""

from __future__ import annotations

import csv
import io

from fingertip.page.html import Markup, element

_COLUMNS = ("Quantity", "References", "Value", "Footprint", "Rating", "Manufacturer", "MPN", "LCSC", "Note")
_REFERENCES = "References"
_CAPTION = "bill of materials; board/bom.csv names the source of each number"


def render_bom(text: str) -> Markup:
    """Render `bom.csv`, without the columns that are empty."""
    lines = list(csv.DictReader(io.StringIO(text)))
    columns = [name for name in _COLUMNS if any(line.get(name) for line in lines)]
    head = (element("th", name if name in ("MPN", "LCSC") else name.lower(), scope="col") for name in columns)
    rows = (
        element(
            "tr",
            *(element("td", line[name], class_="references" if name == _REFERENCES else None) for name in columns),
            data_parts=line[_REFERENCES],
        )
        for line in lines
    )
    whole = element(
        "table",
        element("caption", _CAPTION),
        element("thead", element("tr", *head)),
        element("tbody", *rows),
        class_="broad",
        id="bom",
    )
    scroll = element("div", whole, class_="scroll", role="group", tabindex="0", aria_label=_CAPTION)
    # The script shows the line of controls; without it there is nothing to control.
    return Markup(f"{element('div', class_='row', id='bom-controls', hidden=True)}{scroll}")
