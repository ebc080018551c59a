"""Part as a CadQuery script, which gives the same solid as the STEP file where cadquery alone is installed."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Iterator
from itertools import chain, count
from pathlib import Path

from fingertip.cad.files.named_dimensions import Definition, Names, build_with_names, literal
from fingertip.cad.shapes.parts import PARTS
from fingertip.design import Design
from fingertip.design.geometry.solids import Difference, Intersection, Primitive, Scaled, Solid, Union, call_of

_WIDTH = 110
_WORD = re.compile(r"[a-zA-Z_]\w*")
_RATIO = re.compile(r"weight|scale|slope|shrinkage|ratio|fullness|drop|flank")
"""Names of numbers that are no lengths."""
_SCRIPT = '''"""{title} of the fingertip {design}, in CadQuery: run it with Python, or open it in CQ-editor.

Lengths are in mm; x is the width, y points to the back, z to the tip. A number that is changed below changes this part
where its name stands, and is checked by nothing. What was computed by more than arithmetic stands as a number without a
name, and does not follow. To change a parameter with all that follows from it, make a new script:
fingertip build design.toml --formats cq --set TABLE.KEY=VALUE
"""

{imports}# Dimensions

{dimensions}

# Primitives

{functions}

# {title}

{statements}

if "show_object" in globals():  # in CQ-editor, or imported from ocp_vscode
    show_object({part}, name="{part}")
else:
    size = {part}.BoundingBox()
    print(f"{part}: {{size.xlen:.3f}} x {{size.ylen:.3f}} x {{size.zlen:.3f}} mm, {{volume({part}.wrapped):.3f}} mm3")
'''


def write_script(design: Design, part: str) -> bytes:
    """Write a part as a script: its dimensions by name, the functions of its primitives, and a statement for each."""
    names = Names(design)
    solid, solids = build_with_names(PARTS[part].solid, names.design)
    definitions = names.confirmed(design)
    imports, functions = _read_sources()
    statements = _Statements(solids, {part, *_WORD.findall(imports + functions), *definitions}).write(part, solid)
    text = _SCRIPT.format(
        title=part.replace("_", " ").capitalize(), design=design.name, part=part, imports=imports, functions=functions,
        dimensions="\n".join(_define(definitions, statements)), statements=statements,
    )  # fmt: skip
    return text.encode()


def _read_sources() -> tuple[str, str]:
    """Read imports and functions of the modules that a script holds."""
    kernel = Path(__file__).parents[1] / "kernel"
    names = "cadquery_primitives.py", "bezier.py"
    (own, primitives), (others, faces) = (
        (kernel / name).read_text(encoding="utf-8").partition('"""\n\n')[2].split("# Functions\n\n") for name in names
    )
    kept = [line for line in own.rstrip().splitlines() if "fingertip" not in line]
    imports = "\n".join([*kept[:-1], *(line for line in others.splitlines() if line.startswith("from OCP"))])
    return f"{imports}\n\n", f"{faces}\n\n{primitives}".rstrip()


class _Statements:
    """Statements that make a solid: one for each primitive, and for each other solid that has a name."""

    def __init__(self, names: dict[Solid, str], taken: set[str]) -> None:
        self._names, self._taken = names, taken
        self._lines: list[str] = []
        self._written: dict[Solid, str] = {}

    def write(self, part: str, solid: Solid) -> str:
        self._add(f"{part} = {self._express(solid)}.Solids()[0]")
        return "\n".join(self._lines)

    def _add(self, statement: str) -> None:
        """Add a statement, broken after commas where it is too long."""
        self._lines += _wrap(statement.replace(" ", "\xa0").replace(",\xa0", ", "), "    ")

    def _refer(self, solid: Solid) -> str:
        """Write a solid as a name, after a statement that makes it, or without a name as it is made."""
        if solid not in self._written:
            text = self._express(solid)
            if not isinstance(solid, Primitive) and solid not in self._names:
                return text
            base = self._names.get(solid) or text.partition("(")[0]
            name = next(each for each in chain([base], (f"{base}_{i}" for i in count(1))) if each not in self._taken)
            self._taken.add(name)
            self._written[solid] = name
            self._add(f"{name} = {text}")
        return self._written[solid]

    def _express(self, solid: Solid) -> str:
        match solid:
            case Union(united):
                return f"{self._refer(united[0])}.fuse({self._list(united[1:])})"
            case Difference(first, subtracted):
                return f"{self._refer(first)}.cut({self._list(subtracted)})"
            case Intersection(common):
                return ".intersect(".join([self._refer(common[0]), *(f"{self._refer(each)})" for each in common[1:])])
            case Scaled(inner, factor):
                return f"{self._refer(inner)}.scale({literal(factor)})"
            case _:
                name, arguments = call_of(solid)
                return f"{name}({', '.join(map(literal, arguments))})"

    def _list(self, solids: Iterable[Solid]) -> str:
        return ", ".join([self._refer(solid) for solid in solids])


def _wrap(text: str, indent: str) -> list[str]:
    lines = textwrap.wrap(text, _WIDTH, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)
    return [line.replace("\xa0", " ") for line in lines]


def _define(definitions: dict[str, Definition], text: str) -> Iterator[str]:
    """Define the numbers that a text needs, each before those that are computed from it."""
    used, lines = set(_WORD.findall(text)), list[str]()
    for name, defined in reversed(definitions.items()):
        if name in used:
            used |= set(_WORD.findall(defined.text))
            unit = "" if name.endswith(("_mm", "_percent", "_deg")) else "1" if _RATIO.search(name) else "mm"
            meaning = defined.description.replace("[mm]", "").partition(". ")[0].strip().rstrip(".")
            line, notes = f"{name} = {defined.text}", ": ".join(filter(None, (unit, " ".join(meaning.split()))))
            lines += reversed(_wrap(line.replace(" ", "\xa0") + f"\xa0\xa0#\xa0{notes}" * bool(notes), "    # "))
    return reversed(lines)
