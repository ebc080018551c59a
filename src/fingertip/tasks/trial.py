"""Trial of a design: a simulated one, and the slip that its detector finds in it. It runs in a process of its own."""

from __future__ import annotations

import json
from pathlib import Path

from fingertip.catalogues import output_files
from fingertip.design import Design
from fingertip.detection.files import FileDetection, detect_file
from fingertip.foundation import extras
from fingertip.foundation.files import temporary_folder
from fingertip.foundation.progress import ReportProgress, Work
from fingertip.sim.runs.files import SceneFile
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.simulation import load_simulation
from fingertip.sim.trace_file import encode_trace
from fingertip.slip.detectors.registry import find_second_column
from fingertip.slip.report import as_data, draw

DETECTOR = "fast"
"""Detector of the trial: the best there is."""


def simulate_and_detect(
    design: Design, progress: ReportProgress = lambda message: None
) -> tuple[dict[str, bytes], FileDetection]:
    """Simulate a trial, and detect slip in its trace as it is read back from a file."""

    work = Work("", {"simulated trial": 3.0, "detection of slip in it": 2.0}, progress)
    work.begin("simulated trial")
    scene = load_simulation().scene
    assert isinstance(scene, SceneFile)
    if second := find_second_column(design, DETECTOR):
        scene = scene.model_copy(update={"outputs": [*scene.outputs, f"sampled_{second}"]})
    result = run_scene(design, scene)
    contents = {output_files.TRACE: encode_trace(result.time_s, result.columns, Path(output_files.TRACE))}
    work.begin("detection of slip in it")
    with temporary_folder() as temporary:
        path = temporary / output_files.TRACE
        path.write_bytes(contents[output_files.TRACE])
        found = detect_file(path, design, DETECTOR, origin=result.trace.origin)
    data = as_data(found.detection, found.noise)
    contents[output_files.DETECTION] = (json.dumps(data, indent=2, allow_nan=False) + "\n").encode()
    if extras.is_installed("matplotlib"):
        contents[output_files.PLOT] = draw(found.trace, found.detection, f"{design.name}: simulated trial")
    return contents, found
