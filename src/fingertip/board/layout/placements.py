"""The boards' placements: one file for each variant and supply in the folder `places`, made to be edited by hand.

All are 40 x 25 mm with all parts in front; sensor and supply enter left, signals leave right. After a change run
`python -m fingertip.board.layout.routing.reroute`, which makes the tracks anew.
"""

from __future__ import annotations

import functools
import json
from pathlib import Path

from fingertip.board.layout.placement import Placement, Spot

PLACES = Path(__file__).parent / "places"


@functools.cache
def load_placement(name: str) -> Placement:
    """The placement of this name, such as "article_split"."""
    data = json.loads((PLACES / f"{name}.json").read_text("utf-8"))
    return Placement(
        data["width"],
        data["height"],
        {reference: Spot(x, y, angle) for reference, (x, y, angle) in data["spots"].items()},
        {reference: (x, y) for reference, (x, y) in data["names"].items()},
        tuple((words, x, y) for words, x, y in data["words"]),
    )
