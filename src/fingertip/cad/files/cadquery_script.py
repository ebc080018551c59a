"""Parts as a CadQuery script, which gives the same solids as the
STEP files where cadquery alone is installed.
"""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path

from fingertip.cad.files import script_parameters
from fingertip.cad.files.script_text import WIDTH, Text, find_words, wrap_code
from fingertip.cad.files.trace import Trace, name_letters, name_sensor
from fingertip.cad.shapes.engraving import STROKE_WIDTH, letter_outlines
from fingertip.cad.shapes.finger import sensor_body
from fingertip.cad.shapes.mold import LABEL
from fingertip.cad.shapes.parts import PARTS, hardware, parts_by_name, shapes_of_parameters
from fingertip.design import Design
from fingertip.design.geometry import outlines, profile
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds
from fingertip.design.rules.ruleset import find_violations
from fingertip.design.search import RULES
from fingertip.foundation.numerics import bisect

_CARRIED = {
    "cq_numbers": Path(profile.__file__),
    "cq_outlines": Path(outlines.__file__),
    "cq_parameters": Path(script_parameters.__file__),
    "cq_solids": Path(__file__).parents[1] / "kernel" / "cadquery_primitives.py",
}
"""Files of the modules that scripts carry.
That of the primitives is not imported: it would load cadquery.
"""
_REPLACED = {
    r"  # (fmt|noqa): .*": "",
    r"from fingertip\.foundation\.numerics import bisect": "import "
    f"itertools\n\n\n{inspect.getsource(bisect)}",
    r"from fingertip\.design\.geometry\.solids .*": (
        "from cq_solids import box as Box, cone as Cone, prism as Prism, union  # noqa\n\nAxis, "
        "Solid = str, object"
    ),
    r"if TYPE_CHECKING:\n(    .*\n)+": (
        "from collections.abc import Callable\n\nArray, Pair = Sequence[float], tuple[float, "
        "float]\n"
    ),
    r"TYPE_CHECKING, ": "",
}
"""Text of modules that reads otherwise where they stand beside a script."""
_SCRIPT = '''"""{title} of the fingertip {design}, in CadQuery: run it with Python, or open it in CQ-editor."""

# Lengths are in mm; x is the width, y points to the back, z to the tip. Change a number under "Parameters", and all
# statements follow. Bone, skin, mold and core share sizes: change those in CHANGES of finger.cq.py, or they do not fit.
# In brackets stands where the program's rules (walls, fit) allow a number while all others stay; scripts check none.
# With all checks, strength too, and for choices: fingertip build design.toml --formats cq --set NAME=VALUE

{math}import cadquery as cq
{imports}

# Parameters

{parameters}

# Fixed for this design

{fixed}

require = settle(globals())  # takes CHANGES of finger.cq.py; raises its REFUSAL beyond bounds, or where require fails

# {title}

{statements}

# Add your own features here. For own fillets write .solids().clean() above: it merges faces, before tags name them.

if show := globals().get("show_object"):  # in CQ-editor, or imported from ocp_vscode
    show({part}, name="{part}")
elif __name__ == "__main__":
    size = {part}.val().BoundingBox()
    print(f"{part}: {{size.xlen:.3f}} x {{size.ylen:.3f}} x {{size.zlen:.3f}} mm, {{volume({part}.val()):.3f}} mm3")
    cq.exporters.export({part}, "{part}.step")
'''  # noqa: E501
_FINGER = '''"""The finger {design} in its closed mold, by scripts beside it: the core lies where the bone will."""

import sys
from pathlib import Path
from runpy import run_path

import cadquery as cq

# Other values for parameters of the scripts, in all of them at once, such as {{"bone_wall_mm": 1.0}}
CHANGES = {{}}

COLOURS = {{
{colours}
}}
TOOLS = "{tools}".split()  # Printed too, but no parts of the finger in its mold
SCALE = {scale}  # Compensation of the printer in STL files of printed parts: printer.scale_percent / 100
folder = Path(globals().get("__file__", "")).parent  # the current one under CQGI
sys.path.insert(0, str(folder))
settings = {{"CHANGES": CHANGES, "REFUSAL": SystemExit if __name__ == "__main__" else ValueError}}
parts = {{name: run_path(str(folder / f"{{name}}.cq.py"), settings)[name] for name in COLOURS}}
finger = cq.Assembly(name="{design}")
for name, part in parts.items():
    if name not in TOOLS:
        finger.add(part, name=name, color=cq.Color(*COLOURS[name]))

if show := globals().get("show_object"):  # in CQ-editor, or imported from ocp_vscode
    for name, part in parts.items():
        show(part, name=name)
    show(finger, name="finger")
elif __name__ == "__main__":
    out = folder / "out"
    out.mkdir(exist_ok=True)
    finger.export(str(out / "{design}.step"))
    for name, part in parts.items():
        cq.exporters.export(part, str(out / f"{{name}}.step"))
        scaled = part.val().scale(1.0 if name in ("skin", "sensor") else SCALE)
        cq.exporters.export(scaled, str(out / f"{{name}}.stl"), tolerance=0.01, angularTolerance=0.1)
    print(f"{{out}}: {design}.step, and .step and .stl of {{', '.join(parts)}}")
'''  # noqa: E501


def write_script(design: Design, part: str) -> bytes:
    """Write a part, or the sensor, as a script: parameters, derived
    lengths, and a statement for each solid.
    """
    trace = Trace(design, PARTS[part].solid if part in PARTS else sensor_body)
    modules = write_functions(design)
    held = {
        name[:-3]: {*re.findall(r"(?m)^(?:def )?(\w+)(?:\(| = )", text.decode())}
        for name, text in modules.items()
    }
    text = Text(trace, part, set().union(*held.values()))
    ranges = find_ranges(design)
    made = "\n".join(text.write_statements())
    imports = []
    words = find_words(made) | {"settle", "volume"}

    for module, names in held.items():
        listed = ", ".join(sorted(names & words))
        if listed:
            imports += wrap_code(
                f"from {module} import {f'({listed})' if len(listed) > WIDTH // 2 else listed}"
            )

        words -= names

    return _SCRIPT.format(
        title=part.replace("_", " ").capitalize(),
        design=design.name,
        part=part,
        statements=made.lstrip(),
        math="import math\n\n" * ("math" in words),
        imports="\n".join(imports),
        parameters="\n".join(text.write_atoms(words, ranges)),
        fixed="\n".join([*_describe_choices(design, part), *text.write_atoms(words)]),
    ).encode()


def write_functions(design: Design) -> dict[str, bytes]:
    """Write the modules that the scripts of a design carry: functions,
    bounds of parameters, outlines of letters.
    """
    texts: dict[str, str] = {}
    for name, path in _CARRIED.items():
        texts[name] = path.read_text(encoding="utf-8")
        for pattern, replacement in _REPLACED.items():
            texts[name] = re.sub(pattern, replacement, texts[name])

    for word in (LABEL, design.name):
        letters = wrap_code(f"{name_letters(word)} = {letter_outlines(word, STROKE_WIDTH)}")
        texts["cq_outlines"] += "\n".join(("", *letters, ""))

    ranges = find_ranges(design).items()
    rows = (
        f'    "{path}": ({low:g}, {value!r}, {high:g}),\n'
        for path, (value, low, high, *_) in ranges
    )
    texts["cq_parameters"] = texts["cq_parameters"].replace("= {}", f"= {{\n{''.join(rows)}}}", 1)
    return {f"{name}.py": text.encode() for name, text in texts.items()}


@lru_cache(8)
def find_ranges(design: Design) -> dict[str, tuple[float, ...]]:
    """Find value and bounds of each number that shapes parts, and
    from where to where it may change alone.
    """
    named = name_sensor(design)
    found = {}

    for path in shapes_of_parameters(named):
        value = named.value(path)
        if isinstance(value, float):
            bounds = find_bounds(PARAMETERS[path])
            ends = bounds.minimum or 0.0, bounds.maximum or 0.0
            found[path] = (value, *ends, *(_find_last(named, path, end) for end in ends))

    return found


def _find_last(design: Design, path: str, end: float) -> float:
    """Find the last number on the way to an end of its bounds with
    which a design passes all rules, to 0.001.
    """
    value = design.value(path)

    def at(share: float) -> float:
        return float(round(value + share * (end - value), 3))

    def passes(share: float) -> bool:
        return not any(find_violations(RULES, design.with_values({path: at(share)})))

    return (
        end if passes(0.999) else at(bisect(passes, 0.0, 1.0, halvings=17)[0])
    )  # 0 itself may be another shape


def drop_unused(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """Leave out of the files of a design the functions that none of them calls."""
    text = "\f".join(each.decode() for each in files.values())
    before = ""

    while text != before:
        before = text
        defined = re.findall(r"\ndef (\w+)", text)
        once = "|".join(name for name in defined if len(re.findall(rf"\b{name}\b", text)) == 1)
        text = re.sub(rf"\n\n\ndef ({once})\((.|\n)*?(?=\n\n\n|\n*(\f|\Z))", "", before)

    return dict(zip(files, map(str.encode, text.split("\f")), strict=True))


def write_finger(design: Design) -> dict[str, bytes]:
    """Write the script of the whole finger with its mold, and that of its sensor."""
    parts = parts_by_name(design)
    colours = {name: part.colour for name, part in parts.items()}
    colours |= {
        item.name: item.colour for item in hardware(design, ("bone",)) if item.name == "sensor"
    }
    lines = "\n".join(f'    "{name}": {colour},' for name, colour in colours.items())
    tools = " ".join(name for name, part in parts.items() if part.is_tool)
    text = _FINGER.format(
        design=design.name,
        colours=lines,
        tools=tools,
        scale=design.printer.scale_percent / 100.0,
    )

    return {"finger.cq.py": text.encode(), "sensor.cq.py": write_script(design, "sensor")}


def _describe_choices(design: Design, part: str) -> Iterator[str]:
    """Describe the choices, of which other ones give other statements."""
    read = (path for path, names in shapes_of_parameters(design).items() if part in names)
    chosen = [
        f"{path} = {value}" for path in read if not isinstance(value := design.value(path), float)
    ]
    text = f"# What follows holds for {', '.join(chosen)}" * bool(chosen)
    yield from textwrap.wrap(text, WIDTH, subsequent_indent="# ")
