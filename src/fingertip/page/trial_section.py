"""Trial of a page: the simulated trace, read back from its file, and the slip that the detector finds in it."""

from __future__ import annotations

import json

from fingertip.detect_trace import detect_file
from fingertip.page.html import Markup, element, join
from fingertip.page.sources import COMMANDS, Sources
from fingertip.page.trial_plot import draw_onset, draw_trial
from fingertip.slip.traces.origin import DETECTION, SIGNAL_FOLDER, TRACE, parse_origin
from fingertip.temporary import TemporaryFolder


def _find_detector(detection: bytes | None) -> str:
    """Find the detector of the detection beside the trace; without one, the best there is."""
    return str(json.loads(detection)["detector"]) if detection else "fast"


def render_trial(sources: Sources) -> Markup:
    """Render trial and detection, or say how to make them."""
    if SIGNAL_FOLDER in sources.remarks:
        return element("p", sources.remarks[SIGNAL_FOLDER], class_="note")
    data = sources.files.get(f"{SIGNAL_FOLDER}/{TRACE}")
    if data is None:
        remedy = (
            f"{SIGNAL_FOLDER}/{TRACE} is missing; in the folder of this page, ",
            element("code", COMMANDS[SIGNAL_FOLDER]),
            " makes it.",
        )
        return element("p", *remedy, class_="note")
    with TemporaryFolder() as temporary:
        path = temporary / TRACE
        path.write_bytes(data)
        detection = sources.files.get(f"{SIGNAL_FOLDER}/{DETECTION}")
        found = detect_file(path, sources.design, _find_detector(detection), origin=parse_origin(detection))
    onset = draw_onset(found.trace, found.detection)
    parts = [element("h3", "The onset of the slip"), onset] if onset else []
    warnings = [element("p", warning, class_="note") for warning in found.warnings]
    whole = draw_trial(found.trace, found.detection)
    return join((*parts, element("h3", "The whole trial"), whole, *warnings))
