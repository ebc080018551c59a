"""Text of a script: a statement for each solid that has a name, and expressions; long or shared ones have names too."""

from __future__ import annotations

import builtins
import keyword
import re
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, count

from fingertip.cad.files.named_dimensions import Trace
from fingertip.cad.files.named_numbers import Term, term_of
from fingertip.cad.shapes.parts import PARTS
from fingertip.design.files import format_bounds
from fingertip.design.geometry.solids import Difference, Intersection, Primitive, Scaled, Solid, Union, call_of
from fingertip.design.parameters import PARAMETERS

_WIDTH, _NEAREST = 118, 6
"""Width of a line, and the largest number of parameters that a refusal names: those nearest to its condition."""
_AS_IT_IS = ", clean=False)"
"""End of a boolean, whose faces stay as the STEP file has them."""
PRIMITIVES = ("box", "cylinder", "cone", "prism", "stack", "union", "superconic", "elbow_tube", "scaled")
_PATHS = {path.replace(".", "_"): path for path in PARAMETERS}
_LONG, _AGAIN_LONG, _NAMELESS = 72, 16, 40
"""Length above which an expression has a name of its own: used once, used again, and used again but held by nothing."""
_NEVER_NAMED = {"name", "constant", "item", "word", "<", "<=", ">", ">=", "==", "!="}
_RANKS = {"+": 1, "-": 1, "*": 2, "/": 2, "negative": 2, "**": 3}
"""Ranks of operations: the higher one binds more tightly; comparisons have 0, all others 4."""
_PLACES = {"box": "low_x low_y low_z high_x high_y high_z", "superconic": "half_width palmar dorsal"}
"""Meaning of the numbers that a primitive takes."""


class Statements:
    """Statements that make solids, as pieces of text and terms: one for each solid that has a name."""

    def __init__(self, trace: Trace) -> None:
        self.made: list[tuple[str, list[str | Term]]] = []
        self.places: dict[int, str] = {}
        self._trace = trace
        self._keys: dict[int, int] = {}
        self._counts: dict[int, int] = {}
        self._written: dict[int, str] = {}
        self._names: dict[int, str] = {}
        for solid, name in trace.solid_names:
            self._names.setdefault(self._key(solid), name)
        self.functions = {*PRIMITIVES, *trace.functions, "require", "volume"}
        self.taken: set[str] = {*PARTS, *dir(builtins), *keyword.kwlist, *trace.atoms, *self.functions, "cq", "math"}

    def make(self, part: str, solid: Solid) -> None:
        self._count(solid)
        self._names.pop(self._key(solid), None)
        self.made.append((part, self._express(solid)))
        self._written[self._key(solid)] = part

    def _key(self, solid: Solid) -> int:
        """Return a number that solids share if they are equal whatever the parameters are."""
        if id(solid) not in self._keys:
            call = self._trace.calls.get(id(solid))
            terms = [call[1]] if call else [term_of(call_of(solid)[1])] if isinstance(solid, Primitive) else []
            inner = () if terms else map(self._key, _operands(solid))
            factor = term_of(solid.factor).key if isinstance(solid, Scaled) else 0
            self._keys[id(solid)] = hash((type(solid).__name__, factor, *(t.key for t in terms), *inner))
        return self._keys[id(solid)]

    def _count(self, solid: Solid) -> None:
        key = self._key(solid)
        self._counts[key] = self._counts.get(key, 0) + 1
        if self._counts[key] == 1 and id(solid) not in self._trace.calls:
            for each in _operands(solid):
                self._count(each)

    def _refer(self, solid: Solid) -> list[str | Term]:
        """Write a solid as a name, after a statement that makes it, or without a name as it is made."""
        key = self._key(solid)
        if key not in self._written:
            pieces = self._express(solid)
            base = self._names.get(key)
            if not base and self._counts.get(key, 0) < 2:
                return pieces
            name = self.name(base or "body")
            self._written[key] = name
            self.made.append((name, pieces))
        return [self._written[key]]

    def name(self, base: str) -> str:
        name = next(each for each in chain([base], (f"{base}_{i}" for i in count(1))) if each not in self.taken)
        self.taken.add(name)
        return name

    def _express(self, solid: Solid) -> list[str | Term]:
        if id(solid) in self._trace.calls:
            return [self._trace.calls[id(solid)][1]]
        match solid:
            case Union(solids):
                first, *others = solids
                return [*self._refer(first), ".union(", *self._list(others), _AS_IT_IS]
            case Difference(first, subtracted):
                return [*self._refer(first), ".cut(", *self._list(subtracted), _AS_IT_IS]
            case Intersection(solids):
                first, *others = solids
                each_in = ([".intersect(", *self._refer(each), _AS_IT_IS] for each in others)
                return [*self._refer(first), *chain(*each_in)]
            case Scaled(inner, factor):
                return ["scaled", "(", *self._refer(inner), ", ", term_of(factor), ")"]
            case primitive:
                name, arguments = call_of(primitive)
                for place, item in zip(_PLACES.get(name, "").split(), chain(*arguments), strict=False):
                    self.places.setdefault(term_of(item).key, place)
                return [name, "(", *_join([term_of(each)] for each in arguments), ")"]

    def _list(self, solids: Sequence[Solid]) -> list[str | Term]:
        if len(solids) == 1:
            return self._refer(solids[0])
        return ["stack", "(", *_join(self._refer(each) for each in solids), ")"]


def _operands(solid: Solid) -> tuple[Solid, ...]:
    match solid:
        case Union(solids) | Intersection(solids):
            return solids
        case Difference(first, subtracted):
            return (first, *subtracted)
        case Scaled(inner):
            return (inner,)
    return ()


def _join(listed: Iterable[list[str | Term]]) -> list[str | Term]:
    return [*chain(*([", ", *pieces] for pieces in listed))][1:]


class Text:
    """Text of terms: those that are long or used again have names, and lines that define them."""

    def __init__(self, trace: Trace, statements: Statements) -> None:
        self._trace, self._statements = trace, statements
        self._uses: dict[int, int] = {}
        self._names: dict[int, str] = {}
        self._done: dict[int, tuple[str, int]] = {}
        self.used: set[str] = set()
        self._made: list[tuple[str, list[str]]] = [("", [])]
        self._solid = ""
        for piece in chain(*(pieces for _, pieces in statements.made)):
            if isinstance(piece, Term):
                self._count(piece)

    def write_statements(self) -> list[str]:
        """Write solids, each after the lengths that it needs first, and conditions, after the last length in them."""
        for solid, pieces in self._statements.made:
            self._solid, begin = solid, len(self._made)
            texts = [piece if isinstance(piece, str) else self.write(piece)[0] for piece in pieces]
            if self._made[begin:]:
                self._made.insert(begin, ("", ["", f"# {solid.replace('_', ' ').capitalize()}"]))
            self._made.append((solid, wrap_code(f"{solid} = {''.join(texts)}", "")))
        places = {name: i for i, (name, _) in enumerate(self._made) if name}
        for condition, parameters in self._list_conditions():
            last = max(places.get(word, 0) for word in re.findall(r"\w+", condition))
            line = f"require({', '.join((condition, *map(_literal, (condition, *parameters))))})"
            self._made[last][1].extend(wrap_code(line, ""))
        return [line for _, lines in self._made for line in lines]

    def write_atoms(self, *kinds: str) -> Iterator[str]:
        compared = {(each.operation, each.operands[0].key, each.operands[1].key) for each in self._trace.conditions}
        for name, atom in self._trace.atoms.items():
            if atom.kind in kinds and name in self.used:
                meaning, bounds = atom.meaning, format_bounds(PARAMETERS[_PATHS[name]]) if name in _PATHS else ""
                if any((sign, Term("name", (name,)).key, term_of(0.0).key) in compared for sign in ("!=", ">")):
                    meaning, bounds = meaning.partition("; 0: ")[0], bounds.replace(">= 0,", "> 0,")
                yield from _comment(f"{name} = {_literal(atom.value)}", meaning, f" [{bounds}]" * bool(bounds))

    def _list_conditions(self) -> Iterator[tuple[str, list[str]]]:
        """List the conditions, with the parameters that are nearest to each."""
        written = {self._write_condition(each): each for each in self._trace.conditions if each.is_free}
        for text, term in written.items():
            if text and text.replace(" >= ", " > ") not in written.keys() - {text}:
                names = [name for name in _atoms(term) if self._trace.atoms[name].kind != "fixed"]
                paths = [_PATHS.get(name) or name.replace("sensor_", "custom_sensor.") for name in names]
                yield text, paths[:_NEAREST] + ["TABLE.KEY"] * (len(paths) > _NEAREST)

    def _write_condition(self, term: Term) -> str:
        atoms = _atoms(term).keys()
        kinds = {self._trace.atoms[each].kind for each in atoms}
        if not atoms <= self.used or not kinds & {"parameter", "bought"}:
            return ""
        left, right = term.operands
        if term.operation == "!=" and left.operation != "name" and right.operation == "constant":
            return ""  # it keeps a division from failing
        return self.write(term, names=False)[0]

    def _count(self, term: Term) -> None:
        self._uses[term.key] = self._uses.get(term.key, 0) + 1
        if self._uses[term.key] == 1:
            for each in term.operands:
                if isinstance(each, Term):
                    self._count(each)

    def write(self, term: Term, names: bool = True) -> tuple[str, int]:
        """Write a term, and return its text and rank."""
        if term.key in self._names:
            return self._names[term.key], 4
        if term.key in self._done:
            return self._done[term.key]
        text, rank = self._compose(term, names)
        if term.operation == "name":
            self.used.add(text)
        is_plain = term.operation == "negative" and term.operands[0].operation == "name"
        is_named = names and term.operation not in _NEVER_NAMED and term.is_free and not is_plain
        is_again = self._uses.get(term.key, 0) > 1 and len(text) > _AGAIN_LONG
        if is_named and (is_again or len(text) > _LONG):
            preferred = self._trace.preferred.get(term.key)
            found = preferred[0] if preferred else self._trace.variables.get(term.key)
            if found or (is_again and len(text) > _NAMELESS):
                name = self._statements.name(found or self._suggest(term))
                self._names[term.key] = name
                self._made.append((name, _comment(f"{name} = {text}", preferred[1] if preferred else "")))
                return name, 4
        self._done[term.key] = text, rank
        return text, rank

    def _suggest(self, term: Term) -> str:
        called = re.sub(".*[_.]", "", str(term.operands[0])) if term.operation == "call" else "length"
        return f"{self._solid}_{self._statements.places.get(term.key, called)}"

    def _compose(self, term: Term, names: bool) -> tuple[str, int]:
        def inner(each: Term, rank: int = 0) -> str:
            text, own = self.write(each, names)
            return text if own >= rank else f"({text})"

        match term.operation, term.operands:
            case "name" | "word" | "probe", (text,):
                return text, 4
            case "constant", (value,):
                text = _literal(value if names else float(value))
                return text, 2 if text.startswith("-") else 4
            case "tuple", terms:
                return f"({', '.join(map(inner, terms))}{',' * (len(terms) == 1)})", 4
            case "item", (whole, i):
                return f"{inner(whole, 4)}[{i}]", 4
            case "call", (name, *terms):
                return f"{name}({', '.join(map(inner, terms))})", 4
            case "lambda", (variable, body):
                return f"lambda {variable}: {inner(body)}", 0
            case "negative", (value,):
                return f"-{inner(value, 2)}", 2
            case sign, (left, right):
                rank = _RANKS.get(sign, 0)
                if sign == "+" and right.operation == "negative":
                    sign, right = "-", right.operands[0]
                elif sign in "+-" and right.operation == "constant" and right.operands[0] < 0.0:
                    sign, right = "-" if sign == "+" else "+", Term("constant", (-right.operands[0],))
                return f"{inner(left, rank)} {sign} {inner(right, rank + 1)}", rank
        raise AssertionError(term)


def _atoms(term: Term) -> dict[str, None]:
    """List the names in a term, those first that stand the nearest to it."""
    terms, seen = [term], set[int]()
    for each in terms:  # it grows
        terms += [inner for inner in each.operands if isinstance(inner, Term) and each.key not in seen]
        seen.add(each.key)
    return {each.operands[0]: None for each in terms if each.operation == "name"}


def _literal(value: object) -> str:
    if isinstance(value, tuple | list):
        return f"({', '.join(map(_literal, value))}{',' * (len(value) == 1)})"
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e6:
        return f"{value:.1f}"
    return f'"{value}"' if isinstance(value, str) else repr(value)


def _comment(line: str, meaning: str, bounds: str = "") -> list[str]:
    """Write a line with a comment, as much of its first sentence as fits, and bounds; a longer line without one."""
    words = " ".join(meaning.replace(" [mm]", "").partition(". ")[0].split()).rstrip(".")
    while words and len(line) + len(words) + len(bounds) + 4 > _WIDTH:
        words = next(filter(None, (words.rpartition(sign)[0] for sign in ("; ", " (", ": ", ", "))), "")
    return wrap_code(line, "") if not words else [f"{line}  # {words}{bounds}"]


def remark(text: str) -> list[str]:
    return textwrap.wrap(text, _WIDTH, initial_indent="# ", subsequent_indent="# ")


def wrap_code(text: str, indent: str) -> list[str]:
    """Break a statement within brackets where it is too long: after commas, or else at any space."""
    text = re.sub('"[^"]*"', lambda quoted: quoted[0].replace(" ", "\xa0"), text)
    depth, spaced = 0, []
    for before, sign in zip(f" {text}", text, strict=False):
        depth += (sign in "([{") - (sign in ")]}")
        is_open = depth > 0 and not text.startswith('"')
        spaced.append(
            {(True, True): " ", (True, False): "\r"}.get((is_open, before == ","), "\xa0") if sign == " " else sign
        )
    for breaks in ("", "\r"):
        fixed = "".join(" " if each == breaks else "\xa0" if each == "\r" else each for each in spaced)
        lines = textwrap.wrap(
            fixed, _WIDTH, initial_indent=indent, subsequent_indent=f"{indent}    ", break_long_words=False,
            break_on_hyphens=False,
        )  # fmt: skip
        if max(map(len, lines), default=0) <= _WIDTH:
            break
    return [line.replace("\xa0", " ") for line in lines] or [""]
