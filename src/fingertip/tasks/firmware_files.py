"""Files of the library: content, writing to a folder, and comparison with a folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fingertip.catalogues.output_files import FIRMWARE, MANIFEST, PROPERTIES, README
from fingertip.design import Design
from fingertip.documents.firmware import render_readme
from fingertip.firmware.c_sources import LAMP, lamp_sketch, library_sources, read_template
from fingertip.firmware.fingers import ONE_FINGER, Fingers
from fingertip.firmware.packaging import library_manifest, library_properties
from fingertip.foundation.output_set import write_attributes
from fingertip.tasks.manifest_comparison import compare_with_design

SOURCES = "src"
EXAMPLES = "examples"
"""Folders of the library, as Arduino names them."""
_EXAMPLE_FILES = {"slip_pin": ("slip_pin.ino",), "slip_stream": ("slip_stream.ino", "slip_line.h")}
"""Example of one finger -> its files. Arduino names a sketch like its folder."""
_HAND_FILES = {"slip_hand": ("slip_hand.ino",), "slip_stream": _EXAMPLE_FILES["slip_stream"]}
"""The same for several fingers."""


def firmware_files(design: Design, fingers: Fingers = ONE_FINGER) -> dict[str, dict[str, bytes]]:
    """Return the files by folder and name; the same design gives the same bytes."""
    sources = library_sources(design, fingers)
    readme = render_readme(design, fingers).encode()

    # Arduino compiles what stands beside the sketch of a divider: no library to install.
    if not design.board.has_filter:
        return {".": {README: readme}, Path(LAMP).stem: lamp_sketch(design, fingers) | sources}

    folders = {
        ".": {
            README: readme,
            PROPERTIES: library_properties(design),
            MANIFEST: library_manifest(design),
        },
        SOURCES: sources,
    }
    for example, names in (_HAND_FILES if fingers.is_hand else _EXAMPLE_FILES).items():
        files = {name: read_template(f"{EXAMPLES}/{name}").encode() for name in names}
        folders[f"{EXAMPLES}/{example}"] = files

    return folders


def write_firmware(
    design: Design,
    out: str | Path | None = None,
    *,
    fingers: Fingers = ONE_FINGER,
    force: bool = False,
) -> tuple[Path, ...]:
    """Write a design's library to `out/NAME/firmware` by default; return its paths.

    `fingers` are those that the controller reads, as `fingertip.firmware.fingers.plan_fingers`
    gives them. With `force`, files may be overwritten that this function did not write, or that
    were changed since. Without it, a file of these names that is somebody's own raises OutputError,
    as a folder that cannot be written does. Nothing has been written then.
    """
    return plan_firmware(design, FIRMWARE.folder(design, out), fingers=fingers, force=force)()


def plan_firmware(
    design: Design,
    folder: Path,
    *,
    fingers: Fingers = ONE_FINGER,
    force: bool = False,
    top: Path | None = None,
) -> Callable[[], tuple[Path, ...]]:
    """Check that the files can be written; return the function that does.

    Raises OutputError.
    """
    sets = [
        (FIRMWARE.writer(design, folder / place, force, top or folder), contents)
        for place, contents in firmware_files(design, fingers).items()
    ]
    for writer, contents in sets:
        writer.check(contents)

    def write() -> tuple[Path, ...]:
        paths = list[Path]()
        for writer, contents in sets:
            writer.write(contents)
            paths += [writer.folder / name for name in contents]

        write_attributes(folder)
        return tuple(paths)

    return write


def firmware_differences(
    design: Design, folder: str | Path, fingers: Fingers = ONE_FINGER
) -> list[str]:
    """Describe which files of a folder differ from those of a design; empty if equal."""
    expected = dict[str, bytes]()
    for place, contents in firmware_files(design, fingers).items():
        expected |= {f"{place}/{name}": data for name, data in contents.items()}

    return compare_with_design(Path(folder), expected)
