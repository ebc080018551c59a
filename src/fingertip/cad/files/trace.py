"""Solids whose numbers remember how they follow from the parameters of a design.

A part is built once more with such numbers in place of plain ones. It is the same, bit by bit, and
becomes a term that can be written: of solids, and of numbers made of parameters, constants of the
program, arithmetic, and calls of the math module or of `FUNCTIONS`, which scripts hold as they
stand. A comparison of such numbers decides which solid is made: it is noted, and the script asks
again.
"""

from __future__ import annotations

import contextlib
import inspect
import math
import re
import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import is_dataclass
from functools import cached_property, reduce
from types import FrameType, ModuleType, SimpleNamespace
from typing import Any, NamedTuple

from fingertip.cad.files.named_numbers import NOTED, Term, is_named, plain, term_of, wrap
from fingertip.cad.shapes.engraving import letter_outlines
from fingertip.design import Design
from fingertip.design.geometry import conic, outlines, profile
from fingertip.design.geometry.solids import Difference, Intersection, Scaled, Solid, Union, call_of
from fingertip.design.parameters import PARAMETERS

FUNCTIONS = {
    name: each
    for module in (profile, outlines)
    for name, each in vars(module).items()
    if inspect.isfunction(each) and each.__module__ == module.__name__
}
"""Functions of plain numbers, which scripts carry as they stand."""
_MODULES = ("fingertip.cad.shapes.", "fingertip.design.interfaces.", "fingertip.design.geometry")
"""Modules that make solids of parameters."""
_UNSAID = {"spans", *FUNCTIONS}
"""Functions whose name says too little of what they return."""
_SHORT = 7
"""Length up to which the name of a variable says too little without that of its function."""
_LOCK = threading.Lock()


class Atom(NamedTuple):
    """Number in a script as it is."""

    value: Any
    meaning: str
    is_parameter: bool


class Trace:
    """Build of a part with named numbers."""

    def __init__(self, design: Design, maker: Callable[[Design], Solid]) -> None:
        self.atoms: dict[str, Atom] = {}
        self.derived: dict[Term, tuple[str, str]] = {}
        """Derived length, or solid -> its name and meaning."""
        self.variables: dict[Term, str] = {}
        """Number or solid -> the variable that held it, or the function that returned it."""
        self._calls: dict[int, tuple[Solid, Term]] = {}
        self._found: list[tuple[Solid, str, str]] = []
        design = name_sensor(design)
        values = {
            path: self._atom(name_parameter(path), value, declared.description or "", True)
            for path, declared in PARAMETERS.items()
            if isinstance(value := design.value(path), float)
        }

        with _LOCK, self._replaced(), self._watched():
            NOTED.clear()
            self.design = design.with_values(values)
            solid = maker(self.design)
            self.conditions = list(NOTED)
            self.part = self.term(solid)

        for solid, name, meaning in self._found:
            self.variables.setdefault(self.term(solid), name)
            if meaning.startswith("Build "):
                self.derived.setdefault(self.term(solid), (name, meaning))

    def term(self, solid: Solid) -> Term:
        """Return the term of a solid."""
        if id(solid) in self._calls:
            return self._calls[id(solid)][1]

        match solid:
            case Union(solids):
                return Term("union", *map(self.term, solids))
            case Difference(first, cuts):
                return Term("cut", *map(self.term, (first, *cuts)))
            case Intersection(solids):
                return reduce(lambda *both: Term("intersect", *both), map(self.term, solids))
            case Scaled(inner, factor):
                return Term("solid", "scaled", self.term(inner), term_of(factor))

        name, arguments = call_of(solid)
        return Term("solid", name, *map(term_of, arguments))

    def _atom(
        self,
        name: str,
        value: Any,
        meaning: str,
        is_parameter: bool = False,
    ) -> Any:
        while self.atoms.setdefault(name, Atom(value, meaning, is_parameter)).value != value:
            name += "_"

        return wrap(value, Term("name", name))

    @contextlib.contextmanager
    def _replaced(self) -> Iterator[None]:
        """Replace functions and constants in the modules that make solids by those that name.

        Another thread that meets them computes the same numbers.
        """
        functions = {
            name: self._traced(each, f"math.{name}")
            for name, each in vars(math).items()
            if callable(each)
        }
        new: dict[int, Any] = {id(math): SimpleNamespace(**vars(math) | functions)}
        new |= {id(each): self._traced(each, name) for name, each in FUNCTIONS.items()}
        new[id(letter_outlines)] = self._outline_letters
        modules = [each for name, each in sorted(sys.modules.items()) if name.startswith(_MODULES)]
        before = {module: dict(vars(module)) for module in modules}
        meanings = {key: text for module in before for key, text in read_meanings(module).items()}

        for module, names in before.items():
            for name, value in names.items():
                first = value[0] if isinstance(value, tuple) and value else value
                if id(value) in new:
                    setattr(module, name, new[id(value)])
                elif name.isupper() and isinstance(first, float):
                    setattr(
                        module,
                        name,
                        self._atom(name.strip("_"), value, meanings.get((name, value), "")),
                    )

            vars(module).update(min=self._traced(min, "min"), max=self._traced(max, "max"))

        try:
            yield
        finally:
            for module, names in before.items():
                del module.min, module.max
                vars(module).update(names)

    def _traced(self, function: Callable[..., Any], name: str) -> Any:
        def call(*given: Any, **by_name: Any) -> Any:
            if not any(map(is_named, (*given, *by_name.values()))):
                return function(*given, **by_name)

            arguments = given
            if name in FUNCTIONS:
                signature = inspect.signature(function)
                arguments = signature.bind(*given, **by_name).args
                defaults = [each.default for each in signature.parameters.values()]
                while not is_named(arguments[-1]) and arguments[-1] == defaults[len(arguments) - 1]:
                    arguments = arguments[:-1]

            value = function(*map(plain, arguments))
            term = Term("call", name, *map(term_of, arguments))
            if isinstance(value, Solid):
                self._calls[id(value)] = value, Term("solid", *term.operands)
                return value

            if isinstance(value, tuple) and isinstance(value[0], Solid):
                whole = Term("solids", *term.operands)
                self._calls |= {
                    id(each): (each, Term("member", whole, i)) for i, each in enumerate(value)
                }
                return value

            return wrap(value, term)

        return call

    def _outline_letters(self, text: str, stroke_width: float) -> Any:
        return self._atom(name_letters(text), letter_outlines(text, float(stroke_width)), "")

    @contextlib.contextmanager
    def _watched(self) -> Iterator[None]:
        """Note the variables that hold solids and numbers, and the functions that return them."""
        returned: list[tuple[Solid, str, str]] = []

        def watch(frame: FrameType, event: str, result: Any) -> None:
            module = frame.f_globals.get("__name__", "")
            name = frame.f_code.co_name
            is_ours = module.startswith(_MODULES) and not module.endswith(".solids")

            if (
                event != "return"
                or not is_ours
                or name[0] == "<"
                or name[:2] == "__"
                or name in _UNSAID
            ):
                return

            owner = frame.f_locals.get("self")
            meaning = getattr(frame.f_globals.get(name), "__doc__", "") or ""
            declared = getattr(type(owner), name, None)

            if isinstance(declared, cached_property | property) and not is_dataclass(owner):
                if isinstance(result, conic.ConicBody):
                    self.derived.setdefault(term_of(result.spans), (f"{name}_spans", ""))

                for key, each in _list_named(name, result):
                    self.derived.setdefault(
                        term_of(each), (key, declared.__doc__ or "" if each is result else "")
                    )

            name = (
                getattr(owner, "name", name)
                if name == "shapes"
                else name.strip("_").removeprefix("add_")
            )
            for variable, value in frame.f_locals.items():
                if isinstance(value, Solid) and variable != "self":
                    self._found.append((value, variable, ""))
                elif variable != "self":
                    long = variable if len(variable) > _SHORT else f"{name}_{variable}"
                    for key, each in _list_named(long, value):
                        self.variables[term_of(each)] = (
                            key if each is value else self.variables.get(term_of(each), key)
                        )

            if is_named(result):
                self.variables.setdefault(term_of(result), name)

            results = result if isinstance(result, tuple) else (result,)
            if isinstance(result, tuple):
                name = name[:-2] if name.endswith("ches") else re.sub("(?<!s)s$", "", name)

            returned.extend((each, name, meaning) for each in results if isinstance(each, Solid))

        before = sys.getprofile()
        sys.setprofile(watch)
        try:
            yield
        finally:
            sys.setprofile(before)
            self._found += reversed(returned)


def name_sensor(design: Design) -> Design:
    """Give a design its sensor as a custom one, whose sizes are parameters."""
    sizes = {f"custom_sensor.{key}": value for key, value in vars(design.dimensions.sensor).items()}
    own = {path: value for path, value in sizes.items() if path in PARAMETERS}
    return design.with_values({"sensor.model": "custom", **own})


def name_parameter(path: str) -> str:
    return path.replace(".", "_").removeprefix("custom_")


def name_letters(text: str) -> str:
    return f"letters_{text.lower().replace('-', '_')}"


def _list_named(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """List a named value, and those in a set of values."""
    if is_dataclass(value) or hasattr(value, "_fields"):
        for key, each in (vars(value) if is_dataclass(value) else value._asdict()).items():
            yield from _list_named(f"{name}_{key}", each)

    if is_named(value):
        yield name, value


def read_meanings(module: ModuleType) -> dict[tuple[str, Any], str]:
    """Read the texts below the constants of a module, by name and value."""
    texts = re.findall(r'(?m)^([A-Z0-9_]+) = .*\n"""([^"]+)"""', inspect.getsource(module))
    return {(name, vars(module)[name]): text for name, text in texts}
