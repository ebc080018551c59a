"""Parts as a CadQuery script, which gives the same solids as the STEP files where cadquery alone is installed."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from itertools import chain
from typing import cast

from fingertip.cad.files import carried_functions as carried
from fingertip.cad.files.script_text import FUNCTIONS, WIDTH, Text, wrap_code
from fingertip.cad.files.trace import NUMBERS, SOLIDS, Trace, name_letters
from fingertip.cad.shapes.engraving import STROKE_WIDTH, letter_outlines
from fingertip.cad.shapes.finger import sensor_body
from fingertip.cad.shapes.mold import LABEL
from fingertip.cad.shapes.parts import PARTS, hardware, parts_by_name
from fingertip.design import Design
from fingertip.design.geometry.solids import Solid
from fingertip.design.parameters import PARAMETERS
from fingertip.design.rules.ruleset import record_reads

FINGER, _NUMBERS, _SOLIDS, _LETTERS = "finger.cq.py", "cq_numbers", "cq_solids", "cq_letters"
"""Script of the whole finger with its mold, and the modules of the functions of all scripts."""
_SCRIPT = (
    '"""{title} of the fingertip {design}, in CadQuery: run it with Python, or open it in CQ-editor."""'
    + """

# Lengths are in mm; x is the width, y points to the back, z to the tip. All that follows from a parameter follows when
# it is changed here, within its bounds. No other rule checks it; what needs other statements ends with a sentence.
# Sizes that bone, skin, molds and core share are changed in CHANGES of finger.cq.py, else the parts no longer fit.
# With all checks, and for choices: fingertip build design.toml --formats cq --set NAME=VALUE

import math

import cadquery as cq
{imports}

# Parameters

{parameters}

# Fixed for this design

{fixed}

# Lower bound, value in the design, and upper bound of each parameter
{bounds}

# {title}

{statements}

# Add your own features here. Faces are those of the STEP file: before own fillets, {part} = {part}.clean()

if "show_object" in globals():  # in CQ-editor, or imported from ocp_vscode
    show_object({part}, name="{part}")
elif __name__ == "__main__":
    size = {part}.val().BoundingBox()
    print(f"{part}: {{size.xlen:.3f}} x {{size.ylen:.3f}} x {{size.zlen:.3f}} mm, {{volume({part}.val()):.3f}} mm3")
    cq.exporters.export({part}, "{part}.step")
"""
)
_HEADS = {
    _NUMBERS: '"""Numbers that follow from others, for the CadQuery scripts beside this file [mm]."""',
    _LETTERS: '"""Outlines of engraved letters, for the CadQuery scripts beside this file [units of their grid]."""',
}
_FINGER = (
    '"""The whole finger {design} with its mold, without tools (stand, hand_stub), of the scripts beside this one."""'
    + """

from pathlib import Path
from runpy import run_path

import cadquery as cq

# Parameters of the scripts that shall have other values, in all of them, such as {{"skin_width_mm": 18.0}}
CHANGES = {{}}

COLOURS = {{
{colours}
}}
paths = {{name: Path(__file__).with_name(f"{{name}}.cq.py") for name in COLOURS}}
given = {{name: {{key: value for key, value in CHANGES.items() if f"{{key}} = " in path.read_text("utf-8")}}
    for name, path in paths.items()}}
REFUSAL = SystemExit if __name__ == "__main__" else ValueError
if unknown := set(CHANGES).difference(*given.values()):
    raise REFUSAL(f"CHANGES: these are no parameters: {{', '.join(sorted(unknown))}}")
parts = {{name: run_path(str(path), {{"CHANGES": given[name], "REFUSAL": REFUSAL}})[name]
    for name, path in paths.items()}}
finger = cq.Assembly(name="{design}")
for name, part in parts.items():
    finger.add(part, name=name, color=cq.Color(*COLOURS[name]))

if "show_object" in globals():  # in CQ-editor, or imported from ocp_vscode
    for name, part in parts.items():
        show_object(part, name=name)
    show_object(finger, name="finger")
elif __name__ == "__main__":
    print(f"{design}: {{', '.join(parts)}}")
"""
)


def write_script(design: Design, part: str) -> bytes:
    """Write a part, or the sensor, as a script: parameters, derived lengths, and a statement for each solid."""
    trace = Trace(design, _maker(part))
    text = Text(trace, part)
    made = "\n".join(text.write_statements())
    called, fixed = {*re.findall(r"(?<![.\w])(\w+)\(", made), "volume", "settle"} & FUNCTIONS, trace.atoms.items()
    imports: list[str] = []
    for module, each in _carry().items():
        read = {name for name, atom in fixed if name in text.used and each.constants.get(name) == repr(atom.value)}
        text.used -= read
        own = each.functions.keys() if module == _NUMBERS else FUNCTIONS - _carry()[_NUMBERS].functions.keys()
        if names := sorted(read | (called & own)):
            imports += wrap_code(f"from {module} import ({', '.join(names)})", "")
    if letters := [name for name, atom in fixed if atom.kind == "letters" and name in text.used]:
        imports.insert(0, f"from {_LETTERS} import {', '.join(letters)}")
    return _SCRIPT.format(
        title=part.replace("_", " ").capitalize(), design=design.name, part=part, statements=made.lstrip(),
        imports="\n".join(imports), parameters="\n".join(text.write_atoms("parameter", "bought")),
        fixed="\n".join([*_describe_choices(design, part), *text.write_atoms("fixed")]),
        bounds="\n".join(text.write_bounds()),
    ).encode()  # fmt: skip


def write_functions(design: Design) -> dict[str, bytes]:
    """Write the modules of the functions of all scripts, and of the letters in the mold of a design."""
    solids = carried.PRIMITIVES.read_text(encoding="utf-8").splitlines()
    first = solids.index("from __future__ import annotations") + 2
    letters = (f"{name_letters(each)} = {letter_outlines(each, STROKE_WIDTH)}" for each in (LABEL, design.name))
    made = _carry()
    texts = {
        _NUMBERS: [_HEADS[_NUMBERS], "", *sorted(made[_NUMBERS].imports), "", *made[_NUMBERS].write()],
        _SOLIDS: [*solids[:first], *sorted(made[_SOLIDS].imports), *solids[first:], "", "", *made[_SOLIDS].write()],
        _LETTERS: [_HEADS[_LETTERS], *chain(*(("", each) for each in letters))],
    }
    return {f"{name}.py": ("\n".join(_break(lines)) + "\n").encode() for name, lines in texts.items()}


def _break(lines: Iterable[str]) -> Iterator[str]:
    for line in lines:
        code = line.lstrip(" ")
        yield from wrap_code(code, " " * (len(line) - len(code))) if len(line) > WIDTH else (line,)


@cache
def _carry() -> dict[str, carried.Carried]:
    numbers = carried.Carried(NUMBERS)
    solids = carried.Carried((carried.settle, *SOLIDS), numbers, _NUMBERS)
    return {_NUMBERS: numbers, _SOLIDS: solids}


def write_finger(design: Design) -> dict[str, bytes]:
    """Write the script of the whole finger with its mold, and that of its sensor."""
    colours = {name: part.colour for name, part in parts_by_name(design).items() if not part.is_tool}
    colours |= {item.name: item.colour for item in hardware(design, ("bone",)) if item.name == "sensor"}
    lines = "\n".join(f'    "{name}": {colour},' for name, colour in colours.items())
    text = _FINGER.format(design=design.name, colours=lines)
    return {FINGER: text.encode(), "sensor.cq.py": write_script(design, "sensor")}


def _maker(part: str) -> Callable[[Design], Solid]:
    return PARTS[part].solid if part in PARTS else sensor_body


def _describe_choices(design: Design, part: str) -> Iterator[str]:
    """Describe the choices, of which other ones give other statements."""
    tables, reads = record_reads(design)
    _maker(part)(cast(Design, tables))
    chosen = [f"{path} = {value}" for path in PARAMETERS
              if path in reads and not isinstance(value := design.value(path), float)]  # fmt: skip
    text = f"# What follows holds for {', '.join(chosen)}" * bool(chosen)
    yield from textwrap.wrap(text, WIDTH, subsequent_indent="# ")
