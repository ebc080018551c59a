"""Files of a board: content, writing to a folder, and comparison with a folder."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.gate import find_refusals
from fingertip.board.analysis.interference import connect_cables
from fingertip.board.bringup.expected_readings import BoardUnderTest, plan_bring_up
from fingertip.board.circuits.board_circuit import board_circuit, divider_circuit
from fingertip.board.circuits.channels import leave_out_empty
from fingertip.board.circuits.spice import spice_deck
from fingertip.board.fabrication.bom import bill_of_materials
from fingertip.board.fabrication.fabrication_files import find_outdated_files, provenance_record
from fingertip.board.kicad.netlist import kicad_netlist_file
from fingertip.board.kicad.project import MODEL_FOLDER, load_project, model_files
from fingertip.catalogues import output_files
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.documents.board.bringup import render_sheet, render_sketch
from fingertip.documents.board.divider import divider_files
from fingertip.documents.board.readme import folder_readme
from fingertip.documents.wiring import wiring_diagram
from fingertip.foundation import extras
from fingertip.foundation.errors import BoardError, Issue, OutputError, raise_issues
from fingertip.foundation.output_set import (
    Revision,
    SetWriter,
    finish_interrupted,
    hash_parameters,
    write_attributes,
)
from fingertip.pictures.board_assembly import draw_assembly
from fingertip.pictures.drawing.svg_and_pdf import render_pdf, render_svg
from fingertip.tasks.edited_board import find_edited, refuse_other_circuit, revise_edited
from fingertip.tasks.manifest_comparison import compare_with_design

BRING_UP_FILES = (output_files.BRING_UP, output_files.BRING_UP_SKETCH, output_files.WIRING)
"""Names of the files for bringing a board up, which are written where they are asked for."""


def board_files(design: Design) -> dict[str, bytes]:
    """Return the files of a board or a divider by name; the same design gives the same bytes.

    Raises BoardError.
    """
    if not design.board.has_filter:
        return divider_files(design)

    values = board_values(design)
    record = {"parameters": design.board.model_dump(), **values.as_data()}
    text = json.dumps(record, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    channels = design.board.channels
    circuit = board_circuit(values, channels)
    project = load_project(values.variant, channels)
    bandwidth_hz = find_gain_bandwidth_hz(design.board)
    supply_v = design.board.supply_v
    deck_circuit = circuit
    if channels > 1:
        deck_circuit = connect_cables(leave_out_empty(circuit), design.board)

    drawing = draw_assembly(circuit, project.placement, _title(design))
    return {
        output_files.NETLIST: kicad_netlist_file(circuit),
        **project.enter(circuit),
        output_files.ASSEMBLY_DRAWING: render_svg(drawing),
        output_files.DECK: spice_deck(deck_circuit, bandwidth_hz, supply_v),
        output_files.BOM: bill_of_materials(circuit),
        output_files.VALUES: text.encode(),
        output_files.README: folder_readme(circuit, project, values, design),
    }


def _title(design: Design) -> str:
    fingers = f" for {design.board.channels} fingers" if design.board.channels > 1 else ""
    return f"Slip filter board of {design.name}, variant {design.board.variant}{fingers}"


def model_sets(
    folder: Path, force: bool = False, top: Path | None = None
) -> list[tuple[SetWriter, dict[str, bytes]]]:
    """List the folders of 3D models beside a board: writer and content of each."""
    parameters = hash_parameters({})
    sets = dict[str, dict[str, bytes]]()
    top = top or folder

    for path, data in model_files().items():
        library, name = path.split("/")
        sets.setdefault(library, {})[name] = data

    writers = []
    for library, files in sets.items():
        place = folder / MODEL_FOLDER / library
        writer = SetWriter(place, "models", "all boards", parameters, force=force, top=top)
        writers.append((writer, files))

    return writers


def refuse_other_board(design: Design) -> None:
    """Refuse to replace a board of another circuit in the default folder of a design's board.

    Raises OutputError.
    """
    folder = output_files.BOARD.folder(design)
    channels = design.board.channels
    name = design.board.variant if channels == 1 else f"{channels}_fingers"
    finish_interrupted(folder)
    if design.board.has_filter:
        circuit = board_circuit(board_values(design), channels)
    else:
        circuit = divider_circuit(design)

    refuse_other_circuit(folder, kicad_netlist_file(circuit), folder.with_name(f"board_{name}"))


@dataclass(frozen=True)
class BoardPlan:
    """Files of a board that are ready to be written to a folder."""

    writer: SetWriter
    files: Mapping[str, bytes]
    revisions: Mapping[str, Revision]
    """Files among them that somebody edited in KiCad."""
    notes: Sequence[str]
    """Sentence on each of these."""
    models: Sequence[tuple[SetWriter, Mapping[str, bytes]]]

    def write(self, progress: Callable[[str], None]) -> tuple[Path, ...]:
        """Write the files, all or none, then the models, and return the paths of the files.

        Raises OutputError.
        """
        removed = self.writer.write(self.files, revisions=self.revisions)
        for writer, contents in self.models:
            writer.write(contents)

        write_attributes(self.writer.folder)
        for note in self.notes:
            progress(note)

        if removed:
            progress(
                f"removed files of another design: {', '.join(removed)}; --bringup writes those "
                "of this one"
            )

        return tuple(self.writer.folder / name for name in self.files)


def plan_board(
    design: Design,
    folder: Path,
    *,
    force: bool = False,
    bring_up: bool = False,
    top: Path | None = None,
) -> BoardPlan:
    """Plan the board's files, and refuse what the folder cannot take, as `write_board` does.

    `top` is the folder that the user has named, if this one is below it.
    """
    if not design.board.has_filter:
        files = divider_files(design)
        writer = output_files.BOARD.writer(design, folder, force, top)
        writer.check(files)
        return BoardPlan(
            writer=writer,
            files=files,
            revisions={},
            notes=(),
            models=(),
        )

    raise_issues(BoardError, find_refusals(board_values(design).gate))
    files = board_files(design)

    def make_layout(component_values: Mapping[str, str]) -> bytes:
        values = board_values(design)
        circuit = board_circuit(values, design.board.channels)
        for reference, value in component_values.items():
            circuit = circuit.replace(reference, value)

        project = load_project(values.variant, design.board.channels)
        return project.enter(circuit)[output_files.LAYOUT]

    writer = output_files.BOARD.writer(design, folder, force, top)
    models = model_sets(folder, force, top)
    writer.check(())
    revisions, notes = ({}, []) if force else revise_edited(folder, files, make_layout)
    if bring_up:
        files |= bring_up_files(design)

    writer.check(files, revisions)
    for model_writer, contents in models:
        model_writer.check(contents)

    return BoardPlan(
        writer=writer,
        files=files,
        revisions=revisions,
        notes=notes,
        models=models,
    )


def write_board(
    design: Design,
    out: str | Path | None = None,
    *,
    force: bool = False,
    bring_up: bool = False,
    progress: Callable[[str], None] = lambda message: None,
) -> tuple[Path, ...]:
    """Write the board's files, all or none, to `out/NAME/board` by default; return their paths.

    A schematic or layout that somebody edited in KiCad keeps these edits: only values and part
    numbers that differ are entered into it, and `progress` is called with a sentence, as for files
    that are removed. The default folder keeps a board of another circuit, such as another
    variant's. With `force`, both are overwritten, and files of the same names that are somebody's
    own. With `bring_up`, the sheet for bringing the board up is written too; otherwise that of
    another design is removed.

    Raises BoardError if the values cannot be computed, or the board cannot work with them, and
    OutputError if the folder cannot be written, or holds a file of these names that is somebody's
    own and cannot be kept: a schematic or layout if parts, footprints or nets change, any other
    file in any case. Also if the default folder holds a board with other parts, footprints or nets.
    Its files are then unchanged.
    """
    if out is None and not force:
        refuse_other_board(design)

    plan = plan_board(
        design, output_files.BOARD.folder(design, out), force=force, bring_up=bring_up
    )
    return plan.write(progress)


def write_fabrication(
    design: Design, folder: Path, progress: Callable[[str], None], force: bool
) -> tuple[Path, ...]:
    """Write the fabrication files to the folder `fab` of a board's folder, all or none.

    Requires KiCad.

    `made_from.sha256` beside them records which board files they were made from, in the format of
    `sha256sum --check`. Raises MissingLibraryError or BoardError or OutputError.
    """
    from fingertip.board.fabrication.fabrication_files import fabrication_files  # noqa: PLC0415

    writer = check_fabrication(design, folder, force=force)
    values = board_values(design)
    circuit = board_circuit(values, design.board.channels)
    sources = board_files(design)
    placement = load_project(values.variant, design.board.channels).placement
    models = {f"{MODEL_FOLDER}/{path}": data for path, data in model_files().items()}
    files = fabrication_files(sources | models, circuit, placement, progress)

    if extras.is_installed("reportlab"):
        sheet = draw_assembly(circuit, placement, _title(design))
        files[output_files.ASSEMBLY_PDF] = render_pdf([sheet], sheet.name)
    else:
        progress(
            f"{output_files.ASSEMBLY_PDF} is left out: it needs "
            f"{extras.describe_missing('reportlab')}"
        )

    files[output_files.PROVENANCE] = provenance_record(sources, files)
    writer.write(files)
    return tuple(writer.folder / name for name in files)


def check_fabrication(design: Design, folder: Path, *, force: bool = False) -> SetWriter:
    """Refuse fabrication files before work starts; return the writer that they need.

    They follow from the design: beside a schematic or layout that was edited in KiCad, they would
    be those of another board. Raises MissingLibraryError or OutputError.
    """
    from fingertip.board.fabrication.fabrication_files import find_kicad  # noqa: PLC0415

    if not force:
        finish_interrupted(folder)
        message = (
            "was edited, and --fab would export the board without your edits; export it from "
            "KiCad (File, Fabrication "
            "Outputs) and leave --fab out, or add --force to overwrite your edits."
        )
        edited = [name for name in find_edited(folder) if name != output_files.PROJECT]
        if edited:
            raise OutputError(Issue(str(folder / name), message) for name in edited)

    writer = output_files.FABRICATION.writer(
        design, folder / output_files.FAB_FOLDER, force, folder
    )
    writer.check((output_files.PROVENANCE,))
    find_kicad()
    return writer


def board_differences(design: Design, folder: str | Path) -> list[str]:
    """Describe which files of a folder differ from those of a design; empty if equal."""
    expected = board_files(design)
    if design.board.has_filter and (Path(folder) / output_files.BRING_UP).exists():
        expected |= bring_up_files(design)
    if design.board.has_filter:
        expected |= {f"{MODEL_FOLDER}/{path}": data for path, data in model_files().items()}

    return compare_with_design(Path(folder), expected)


def fabrication_differences(
    design: Design, folder: str | Path, expected: bool = False
) -> list[str]:
    """Describe how fabrication files differ from a design's; none matter if `expected`."""
    fab = Path(folder) / output_files.FAB_FOLDER
    is_present = (fab / output_files.PROVENANCE).is_file() or any(fab.glob("slip_filter_*"))
    if not expected and not is_present:
        return []

    return find_outdated_files(fab, output_files.PROVENANCE, board_files(design))


def bring_up_files(design: Design) -> dict[str, bytes]:
    """Return the bring-up sheet, its sketch and the wiring diagram, by name."""
    values = board_values(design)
    channels = design.board.channels
    plan = plan_bring_up(BoardUnderTest.of_design(design, board_circuit(values)), values)

    return {
        output_files.BRING_UP: render_sheet(plan, values, design, output_files.WIRING).encode(),
        output_files.WIRING: wiring_diagram(
            board_circuit(values, channels), design.board.supply_v, design.name
        ),
        output_files.BRING_UP_SKETCH: render_sketch(plan, values, design).encode(),
    }
