"""Numbers that remember how they were computed from the parameters of a design, and the solids made of them.

A part is built once more with such numbers in place of plain ones. It is the same, bit by bit, and each number in its
tree is a term that can be written: of parameters, of constants of the program, of arithmetic, and of calls of functions
of the math module or of `CARRIED`, which a script holds as they stand. A comparison of such numbers decides which solid
is made: it is noted, and the script asks again.
"""

from __future__ import annotations

import contextlib
import inspect
import math
import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from itertools import pairwise
from types import FrameType, ModuleType
from typing import Any

from fingertip.cad.files.named_numbers import RECORDING, Named, Term, is_named, plain, term_of, wrap
from fingertip.cad.shapes import mold
from fingertip.cad.shapes.engraving import letter_outlines
from fingertip.design import Design
from fingertip.design.geometry import conic, dimensions, foot, mold_layout, profile
from fingertip.design.geometry.solids import Difference, Intersection, Scaled, Solid, SuperconicSolid, Union
from fingertip.design.parameters import PARAMETERS
from fingertip.foundation import numerics

NUMBERS = (
    conic.arc_abscissa, conic.weight_of_fullness, conic.farthest_corner, conic.farthest_side, profile.lay_spans,
    profile.lay_crown, profile.palmar_scale, profile.tip_control, foot.foot_line, foot.foot_length,
)  # fmt: skip
"""Functions of plain numbers that scripts carry."""
SOLIDS = (foot.round_foot, foot.flat_foot, mold.extrude, mold.belt_seat, mold.engrave_letter)
"""Functions that make a solid of plain numbers, which scripts carry too."""
_MODULES = ("fingertip.cad.shapes.", "fingertip.design.interfaces.", "fingertip.design.geometry")
"""Modules that make solids of parameters."""
_SHORT = 7
"""Length up to which the name of a variable says too little without that of its function."""
_LOCK = threading.Lock()


@dataclass(frozen=True)
class Atom:
    """Number that stands in a script as it is: its value, and what it means."""

    value: Any
    meaning: str
    kind: str
    """One of "parameter", "bought" and "fixed"."""


class Trace:
    """Build of parts with named numbers."""

    def __init__(self, design: Design) -> None:
        self.atoms: dict[str, Atom] = {}
        self.functions: dict[str, Callable[..., Any]] = {
            each.__name__: each for each in (numerics.bisect, *NUMBERS, *SOLIDS)
        }
        self.preferred: dict[int, tuple[str, str]] = {}
        """Key of a term -> name of a derived length, and its meaning."""
        self.variables: dict[int, str] = {}
        """Key of a term -> variable that held it, or function that returned it."""
        self.solid_names: list[tuple[Solid, str]] = []
        self.calls: dict[int, tuple[Solid, Term]] = {}
        """Identity of a solid -> that solid, and the call that made it."""
        self.conditions: list[Term] = []
        self._design = design

    def build(self, *makers: Callable[[Design], Solid]) -> list[Solid]:
        """Build parts; several at once share what is equal."""
        values = {
            path: self._atom(path.replace(".", "_"), value, declared.description or "", "parameter")
            for path, declared in PARAMETERS.items()
            if isinstance(value := self._design.value(path), float)
        }
        with _LOCK, self._replaced(), self._watched():
            RECORDING.conditions = self.conditions
            try:
                design = self._design.with_values(values)
                solids = [maker(design) for maker in makers]
                for solid in solids:
                    _lay_all(solid)
            finally:
                RECORDING.conditions = None
        return solids

    def _atom(self, name: str, value: Any, meaning: str, kind: str) -> Any:
        while self.atoms.setdefault(name, Atom(value, meaning, kind)).value != value:
            name += "_"
        return wrap(value, Term("name", (name,)))

    @contextlib.contextmanager
    def _replaced(self) -> Iterator[None]:
        """Replace functions, constants and derived lengths in the modules that make solids by those that name."""
        by_identity: dict[int, Any] = {id(math): self._math()}
        by_identity |= {id(each): self._traced(each) for each in NUMBERS}
        by_identity |= {id(each): self._traced(each, makes_solid=True) for each in SOLIDS}
        by_identity[id(numerics.bisect)] = self._bisect
        by_identity[id(letter_outlines)] = self._outline_letters
        for kind in (dimensions.Dimensions, mold_layout.MoldLayout):
            by_identity[id(kind)] = self._derive(kind)
        before: list[tuple[ModuleType, str, Any]] = []
        for module in [each for name, each in sorted(sys.modules.items()) if name.startswith(_MODULES)]:
            meanings = read_meanings(module)
            for name, value in list(vars(module).items()):
                new = by_identity.get(id(value))
                if new is None and name.isupper() and isinstance(_first(value), float):
                    new = self._atom(name.strip("_"), value, meanings.get(name, ""), "fixed")
                if new is not None:
                    before.append((module, name, value))
                    setattr(module, name, new)
            for name, function in (("min", min), ("max", max)):
                setattr(module, name, self._extreme(function))
                before.append((module, name, None))
        try:
            yield
        finally:
            for module, name, value in before:
                if value is None:
                    delattr(module, name)
                else:
                    setattr(module, name, value)

    def _traced(self, function: Callable[..., Any], name: str = "", makes_solid: bool = False) -> Any:
        name = name or function.__name__

        def call(*given: Any, **by_name: Any) -> Any:
            arguments = inspect.signature(function).bind(*given, **by_name).args if by_name else given
            if not any(map(is_named, arguments)):
                return function(*arguments)
            while arguments[-1] is None:
                arguments = arguments[:-1]
            value, term = function(*map(plain, arguments)), _call(name, arguments)
            if makes_solid:
                self.calls[id(value)] = value, term
                return value
            return wrap(value, term)

        return call

    def _math(self) -> Any:
        names = vars(math).items()
        return type("math", (), {
            name: staticmethod(self._traced(each, f"math.{name}")) if callable(each) else each for name, each in names
        })  # fmt: skip

    def _extreme(self, function: Any) -> Any:
        def choose(*given: Any, **how: Any) -> Any:
            values = tuple(given[0]) if len(given) == 1 else given
            if how or not any(isinstance(each, Named) for each in values):
                return function(values, **how)
            return wrap(function(map(float, values)), _call(function.__name__, values))

        return choose

    def _bisect(self, is_below: Callable[[float], bool], low: float, high: float, *, halvings: int) -> Any:
        """Bisect, and write the function: its last comparison, of a probe."""
        found, RECORDING.conditions = RECORDING.conditions, []
        try:
            ends = numerics.bisect(is_below, float(low), float(high), halvings=halvings)
            RECORDING.conditions = []
            is_true = is_below(Named(ends[0], Term("probe", ("y",))))
            condition = RECORDING.conditions[-1] if RECORDING.conditions else None
        finally:
            RECORDING.conditions = found
        if condition is None:
            return ends
        if not is_true:  # where it holds nowhere
            opposite = {"<": ">=", ">=": "<", ">": "<=", "<=": ">"}
            condition = Term(opposite[condition.operation], condition.operands)
        operands = Term("lambda", ("y", condition)), low, high
        return wrap(ends, Term("call", ("bisect", *map(term_of, operands), Term("word", (f"halvings={halvings}",)))))

    def _outline_letters(self, text: str, stroke_width: float) -> Any:
        outlines = letter_outlines(text, float(stroke_width))
        meaning = f'Outlines of the letters "{text}" in units of their grid, fixed by the name of the design'
        return self._atom(f"letters_{text.lower().replace('-', '_')}", outlines, meaning, "fixed")

    def _derive(self, kind: Any) -> Any:
        """Derive a class of lengths that follow from parameters, and name each when it is read."""

        def read(derived: Any, key: str) -> Any:
            value = kind.__getattribute__(derived, key)
            if key.startswith("_") or callable(value):
                return value
            meaning = getattr(getattr(kind, key, None), "__doc__", None) or ""
            value = self._name(key, value, meaning)
            if key in derived.__dict__:  # a property that keeps its value
                derived.__dict__[key] = value
            return value

        return type(kind.__name__, (kind,), {"__getattribute__": read})

    def _name(self, name: str, value: Any, meaning: str = "") -> Any:
        """Name a number, or those of a data class; a plain number of it is one of something bought."""
        if is_dataclass(value) and not isinstance(value, type):
            named = {each.name: self._name(f"{name}_{each.name}", getattr(value, each.name)) for each in fields(value)}
            if all(isinstance(each, float) for each in named.values()):
                self.preferred.setdefault(term_of(tuple(named.values())).key, (name, meaning))
            if name == "sensor":
                named |= {
                    key: self._atom(f"{name}_{key}", each, f"of the {getattr(value, 'label', name)}", "bought")
                    for key, each in named.items()
                    if isinstance(each, float) and not isinstance(each, Named)
                }
            return replace(value, **named)
        if hasattr(value, "_fields"):
            return value._replace(**{key: self._name(f"{name}_{key}", each) for key, each in value._asdict().items()})
        if isinstance(value, Named):
            self.preferred.setdefault(value.term.key, (name, meaning))
        return value

    @contextlib.contextmanager
    def _watched(self) -> Iterator[None]:
        """Note the variables that hold solids and numbers, and the functions that return them."""
        functions: list[tuple[Solid, str]] = []
        module = ""

        def watch(frame: FrameType, event: str, result: Any) -> None:
            nonlocal module
            if event != "return":
                return
            module, name = frame.f_globals.get("__name__", ""), frame.f_code.co_name
            if (
                not module.startswith(_MODULES)
                or module.endswith(".solids")
                or not name.lstrip("_")[:1].isalpha()
                or name[:2] == "__"
            ):
                return
            owner = frame.f_locals.get("self")
            name = getattr(owner, "name", name) if name == "shapes" else name.strip("_").removeprefix("add_")
            for variable, value in frame.f_locals.items():
                if isinstance(value, Solid) and variable != "self" and name not in self.functions:
                    self.solid_names.append((value, variable))
                elif is_named(value):
                    long = variable if len(variable) > _SHORT else f"{name}_{variable}"
                    self.variables[term_of(value).key] = long
            if is_named(result):
                self.variables.setdefault(term_of(result).key, name)
            if name not in self.functions:
                functions.extend((each, name) for each in (result if isinstance(result, tuple) else (result,))
                                 if isinstance(each, Solid))  # fmt: skip

        before = sys.getprofile()
        sys.setprofile(watch)
        try:
            yield
        finally:
            sys.setprofile(before)
            self.solid_names += functions


def _call(name: str, arguments: tuple[Any, ...]) -> Term:
    return Term("call", (name, *map(term_of, arguments)))


def _first(value: Any) -> Any:
    return value[0] if isinstance(value, tuple) and value else value


def read_meanings(module: ModuleType) -> dict[str, str]:
    """Read the texts below the constants of a module."""
    import ast  # noqa: PLC0415

    body, found = ast.parse(inspect.getsource(module)).body, dict[str, str]()
    for statement, after in pairwise(body):
        if isinstance(statement, ast.Assign) and isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
            names = [each.id for each in ast.walk(statement.targets[0]) if isinstance(each, ast.Name)]
            found |= dict.fromkeys(names, str(after.value.value))
    return found


def _lay_all(solid: Solid) -> None:
    """Compute the spans of all bodies, while what they are computed of is named."""
    match solid:
        case Union(solids) | Intersection(solids):
            for each in solids:
                _lay_all(each)
        case Difference(first, subtracted):
            for each in (first, *subtracted):
                _lay_all(each)
        case Scaled(inner):
            _lay_all(inner)
        case SuperconicSolid(body):
            body.spans  # noqa: B018 # it keeps its value
