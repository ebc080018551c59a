"""Text of terms: statements that make solids, names for numbers that
are long or used again, and line breaks.
"""

from __future__ import annotations

import builtins
import keyword
import math
import re
import textwrap
from collections.abc import Collection, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from itertools import accumulate, chain, count

from fingertip.cad.files.named_numbers import Term, term_of
from fingertip.cad.files.trace import Trace, name_parameter
from fingertip.cad.shapes.parts import PARTS, tagged_faces
from fingertip.design.parameters import PARAMETERS

WIDTH = 118
_PATHS = {name_parameter(path): path for path in PARAMETERS}
_LONG = 72
_AGAIN_LONG = 16
_NAMELESS = 40
"""Length above which an expression has a name of its own: used once,
used again, and used again but held by nothing.
"""
_NEVER_NAMED = {"name", "constant", "item", "negative"}
_RANKS = {
    "+": 1,
    "-": 1,
    "*": 2,
    "/": 2,
    "negative": 2,
    "**": 3,
}
"""Ranks of operations: the higher one binds more tightly; comparisons have 0, all others 4."""
_MADE = {"union", "cut", "intersect", "solid", "solids", "member"}
"""Operations that make solids."""


class Text:
    """Text of a part: lines of lengths and of solids, each after what it needs."""

    def __init__(self, trace: Trace, part: str, taken: Collection[str] = ()) -> None:
        self._trace = trace
        self._part = part
        self._uses: dict[Term, int] = {}
        self._names: dict[Term, str] = {}
        self._done: dict[Term, tuple[str, int]] = {}
        self._taken = {
            *PARTS,
            *dir(builtins),
            *keyword.kwlist,
            *trace.atoms,
            *taken,
            "require",
            "cq",
            "math",
            "",
        }
        self._made: list[tuple[str, list[str]]] = [("", [])]
        self._solid = part
        for each in (*trace.conditions, trace.part):
            self._count(each)

    def write_statements(self) -> list[str]:
        """Write the part, with tags of faces."""
        self._write_solid(self._part, self._trace.part)
        self._made.append(
            (
                "",
                [
                    f"{self._part} = {self._part}.solids()  # out of the compound that a boolean "
                    "returns"
                ],
            )
        )

        for tag, selectors in tagged_faces(self._trace.design, self._part).items():
            texts = (
                f'"{s}"' if isinstance(s, str) else f"in_plane({self.write(term_of(s))[0]})"
                for s in selectors
            )
            self._made.append(("", [f'{self._part}.faces({").faces(".join(texts)}).tag("{tag}")']))

        places = {name: i for i, (name, _) in enumerate(self._made) if name}
        used = find_words("\n".join(line for _, lines in self._made for line in lines))
        conditions = dict.fromkeys(
            self._write_condition(each, used) for each in self._trace.conditions
        )

        for condition in conditions:
            if condition and condition.replace(" >= ", " > ") not in conditions.keys() - {
                condition
            }:
                last = max(places.get(word, 0) for word in find_words(condition))
                self._made[last][1].extend(
                    wrap_code(f"require({condition}, {_literal(condition)})")
                )

        return [line for _, lines in self._made for line in lines]

    def write_atoms(
        self, used: AbstractSet[str], ranges: Mapping[str, Sequence[float]] | None = None
    ) -> Iterator[str]:
        """Write the parameters, with the ends of their ranges, or else what is fixed."""
        heading = ""
        for name, atom in self._trace.atoms.items():
            if name in used and atom.is_parameter == bool(ranges):
                before = heading
                heading = f"# {name.partition('_')[0].capitalize()}" * bool(ranges)
                yield from [heading] if heading != before else ()
                ends = " [{:g} to {:g}]".format(*ranges[_PATHS[name]][-2:]) if ranges else ""
                ends = ends.replace("[0 ", "[above 0 ") if "; 0: " in atom.meaning else ends
                yield from _comment(f"{name} = {_literal(atom.value)}", atom.meaning, ends)

    def write(self, term: Term, names: bool = True) -> tuple[str, int]:
        """Write a term, and return its text and rank."""
        if term in self._names:
            return self._names[term], 4
        if term in self._done:
            return self._done[term]

        text, rank = self._compose(term, names)
        is_named = names and term.operation not in _NEVER_NAMED | _MADE
        is_again = self._uses.get(term, 0) > 1 and len(text) > _AGAIN_LONG

        if is_named and (is_again or len(text) > _LONG):
            found, meaning = self._trace.derived.get(term) or (self._trace.variables.get(term), "")
            if found or (is_again and len(text) > _NAMELESS):
                name = self._name(
                    found or f"{self._solid}_{'corner' if term.operation == 'tuple' else 'size'}"
                )
                self._names[term] = name
                self._made.append((name, _comment(f"{name} = {text}", meaning)))
                return name, 4

        self._done[term] = text, rank
        return text, rank

    def _write_solid(self, name: str, term: Term) -> None:
        """Write a solid, after those of which it is made and that have
        names, and after the lengths that it needs.
        """
        for inner in self._list_named(term):
            if inner not in self._names:
                known = inner if inner.operation != "solids" else Term("member", inner, 0)
                self._write_solid(self._name(self._trace.variables.get(known, "body")), inner)

        self._solid = name
        begin = len(self._made)
        text = self._compose(term, True)[0]
        meaning = (
            self._trace.derived.get(term, ("", ""))[1]
            .partition(". ")[0]
            .partition("\n")[0]
            .rstrip(".")
        )
        title = name.replace("_", " ")
        is_new = meaning not in self._taken

        if self._made[begin:] or is_new:
            about = meaning.removeprefix("Build ").removeprefix(f"the {title}: ")
            heading = f"# {title.capitalize()}" + f": {about}" * is_new
            self._made.insert(
                begin, ("", ["", *textwrap.wrap(heading, WIDTH, subsequent_indent="# ")])
            )
            self._taken.add(meaning)

        self._made.append((name, wrap_code(f"{name} = {text}")))
        self._names[term] = name

    def _list_named(self, term: Term) -> Iterator[Term]:
        for each in term.operands:
            if isinstance(each, Term) and each.operation in _MADE:
                is_named = (
                    each.operation == "solids"
                    or each in self._trace.variables
                    or self._uses[each] > 1
                )
                yield from (
                    (each,) if is_named and each.operation != "member" else self._list_named(each)
                )

    def _name(self, base: str) -> str:
        name = next(
            each
            for each in chain([base], (f"{base}_{i}" for i in count(2)))
            if each not in self._taken
        )
        self._taken.add(name)
        return name

    def _count(self, term: Term) -> None:
        self._uses[term] = self._uses.get(term, 0) + 1
        if self._uses[term] == 1 or term.operation == "negative":
            for each in term.operands:
                if isinstance(each, Term):
                    self._count(each)

    def _compose(self, term: Term, names: bool) -> tuple[str, int]:
        def inner(each: Term, rank: int = 0) -> str:
            text, own = self.write(each, names)
            return text if own >= rank else f"({text})"

        match term.operation, term.operands:
            case "name", (text,):
                return text, 4
            case "constant", (value,):
                text = _literal(value if names else float(value))
                return text, 2 if text.startswith("-") else 4
            case "tuple", terms:
                return f"({', '.join(map(inner, terms))}{',' * (len(terms) == 1)})", 4
            case "item", (whole, i):
                return f"{inner(whole, 4)}[{i}]", 4
            case "member", (whole, _):
                return f"*{self._names[whole]}", 4
            case "call" | "solid" | "solids", (name, *terms):
                return f"{name}({', '.join(map(inner, terms))})", 4
            case ("union" | "cut" | "intersect") as name, (first, *others):
                texts = list(dict.fromkeys(map(inner, others)))
                tools = ", ".join(texts)
                if len(texts) > 1 or tools.startswith("*"):
                    tools = f"stack({tools})"

                return f"{inner(first, 4)}.{name}({tools}, clean=False)", 4
            case "negative", (value,):
                return f"-{inner(value, 2)}", 2
            case sign, (left, right):
                rank = _RANKS.get(sign, 0)
                if sign in ("+", "-") and right.operation == "negative":
                    sign = "-" if sign == "+" else "+"
                    right = right.operands[0]
                elif sign in "+-" and right.operation == "constant" and right.operands[0] < 0.0:
                    sign = "-" if sign == "+" else "+"
                    right = Term("constant", -right.operands[0])

                return f"{inner(left, rank)} {sign} {inner(right, rank + 1)}", rank

        raise AssertionError(term)

    def _write_condition(self, term: Term, used: AbstractSet[str]) -> str:
        if not term.atoms <= used or not any(
            self._trace.atoms[each].is_parameter for each in term.atoms
        ):
            return ""

        left, right = term.operands
        if left == right or (
            term.operation == "!=" and left.operation != "name" and right.operation == "constant"
        ):
            return ""  # it holds always, or keeps a division from failing

        return self.write(term, names=False)[0]


def find_words(code: str) -> set[str]:
    return set(re.findall(r"(?<![.\w])\w+", code))


def _literal(value: object) -> str:
    if isinstance(value, tuple | list):
        return f"({', '.join(map(_literal, value))}{',' * (len(value) == 1)})"
    if value == math.sqrt(2.0):
        return "math.sqrt(2.0)"
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e6:
        return f"{value:.1f}"

    return f'"{value}"' if isinstance(value, str) else repr(value)


def _comment(line: str, meaning: str, bounds: str = "") -> list[str]:
    """Write a line with a comment, as much of its first sentence as
    fits, and bounds; a longer line without one.
    """
    words = " ".join(meaning.replace(" [mm]", "").partition(". ")[0].split()).rstrip(".")
    while words and len(line) + len(words) + len(bounds) + 4 > WIDTH:
        words = next(
            filter(
                None, (words.rpartition(sign)[0] for sign in ("; ", " (", ": ", ", ", " within "))
            ),
            "",
        )

    return (
        wrap_code(line)
        if not words + bounds
        else [f"{line}  # {words}{bounds}".replace("#  ", "# ")]
    )


def wrap_code(text: str) -> list[str]:
    """Break a statement where it is too long: after commas within
    brackets, outer ones first, or else at any space.
    """
    text = re.sub('"[^"]*"', lambda quoted: quoted[0].replace(" ", "\xa0"), text)
    depths = list(accumulate((sign in "([{") - (sign in ")]}") for sign in text))
    lines: list[str] = []

    for deepest in (1, 2, 3, 4, 0):
        can_break = (
            (0 < depth <= deepest and before == ",") or (depth and not deepest)
            for before, depth in zip(f" {text}", depths, strict=False)
        )
        fixed = "".join(
            "\xa0" if sign == " " and not can else sign
            for sign, can in zip(text, can_break, strict=True)
        )
        lines = textwrap.wrap(
            fixed, WIDTH, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False
        )
        if max(map(len, lines), default=0) <= WIDTH:
            break

    return [line.replace("\xa0", " ") for line in lines] or [""]
