"""Errors that name the field, its value, the bound it violates and a remedy, and the check of types
of arguments.

Input may be of any length and hold any character. What a message repeats of it is shortened, and
control characters are escaped, so that a message stays one line that a terminal prints as it is.
Lines below it, such as those of a difference, are indented: no text of a file passes for a message
of its own.
"""

from __future__ import annotations

import contextlib
import functools
import inspect
import itertools
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from types import UnionType
from typing import Any, TypeVar, cast, get_args, get_origin

MAX_VALUE_LENGTH = 80
"""Maximum length of a value that a message repeats [characters]."""
_MAX_WORD_LENGTH = 400
"""Maximum length of a word in a message, such as a path [characters]."""
_MAX_MESSAGE_LENGTH = 4000
"""Maximum length of a message [characters]. The longest lists all names of a sweep's outputs."""
_KEPT_END = 0.4
"""Share of a shortened text that its end takes, which holds the remedy."""
_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Characters that move the cursor, change colour or direction of writing, or cannot be encoded."""
_LINE_BREAK = re.compile(r"\n(?!  )")
"""Line break before a line that is not indented."""
_PASTED = re.compile(r"(=(?:'[^']*'|\S+)|\b(?:least|most|and|or) -?\d[\d.e+-]*)\.$")
"""Value at the end of a message. Users paste it, and would paste a full stop with it."""
_LONG_WORD = re.compile(rf"\S{{{_MAX_WORD_LENGTH + 1},}}")


def escape_control(text: str, spared: str = "") -> str:
    """Escape control characters as Python writes them, except those in `spared`."""
    if text.isprintable():
        return text

    def escape(match: re.Match[str]) -> str:
        character = match[0]
        return character if character in spared else ascii(character)[1:-1]

    return _CONTROL.sub(escape, text)


def escape_message(text: str) -> str:
    """Escape control characters, except line breaks before indented lines."""
    return _LINE_BREAK.sub(r"\\n", escape_control(text, spared="\n"))


def join_words(words: Iterable[str], last_word: str = "and") -> str:
    """Join words as "a, b and c"."""
    *first, last = words
    return f"{', '.join(first)} {last_word} {last}" if first else last


def shorten(text: str, length: int) -> str:
    """Replace the middle of a text of more than `length` characters by a note of their number."""
    if len(text) <= length:
        return text

    end = int(_KEPT_END * length)
    return f"{text[: length - end]}...({len(text)} characters)...{text[len(text) - end :]}"


def quote_value(value: Any) -> str:
    """Write a value as Python does, shortened, for a message that repeats it."""
    if isinstance(value, str | bytes) and len(value) > MAX_VALUE_LENGTH:
        return f"{value[:MAX_VALUE_LENGTH]!r}... ({len(value)} characters)"

    return shorten(repr(value), MAX_VALUE_LENGTH)


def _cut(text: str) -> str:
    """Shorten long words, and then the whole text."""
    if len(text) > _MAX_WORD_LENGTH:
        text = _LONG_WORD.sub(lambda match: shorten(match[0], _MAX_WORD_LENGTH), text)
        text = shorten(text, _MAX_MESSAGE_LENGTH)

    return text


@dataclass(frozen=True)
class Issue:
    """One problem with the input, as the command line names it; `str` names it as in Python."""

    field: str
    """Location of the problem: a parameter such as `skin.width_mm`, a file, option or column."""
    message: str
    """The problem in one sentence: value, bound and remedy."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "field", escape_control(_cut(self.field)))
        object.__setattr__(self, "message", _PASTED.sub(r"\1", escape_message(_cut(self.message))))

    @property
    def typed(self) -> str:
        """The sentence for the command line, whose options it names."""
        return f"{self.field}: {self.message}" if self.field else self.message

    def __str__(self) -> str:
        return as_arguments(self.typed)


class FingertipError(Exception):
    """Base class of every error that is raised on purpose.

    It carries all issues found, not only the first.
    """

    def __init__(self, issues: Issue | str | Iterable[Issue]) -> None:
        if isinstance(issues, str):
            issues = Issue("", issues)

        self.issues: tuple[Issue, ...] = (issues,) if isinstance(issues, Issue) else tuple(issues)
        super().__init__("\n".join(str(issue) for issue in self.issues))


def raise_issues(kind: type[FingertipError], *issues: Iterable[Issue]) -> None:
    """Raise an error of all issues, if there are any."""
    all_issues = tuple(itertools.chain(*issues))
    if all_issues:
        raise kind(all_issues)


@contextlib.contextmanager
def gather(issues: list[Issue], prefix: str = "") -> Iterator[None]:
    """Add the issues of an error to a list, so that all are reported at once.

    `prefix` is put before their fields.
    """
    try:
        yield
    except FingertipError as error:
        issues += (
            Issue(f"{prefix}{issue.field}", issue.message) if prefix else issue
            for issue in error.issues
        )


class ArgumentError(FingertipError, TypeError):
    """An argument of a function is of a type that the function does not take."""


class InputFileError(FingertipError):
    """A file cannot be read: it is missing, no regular file, or too large."""


class TomlFileError(FingertipError):
    """A TOML file cannot be read, or is of another kind than expected."""


class DesignError(FingertipError):
    """A design file, or a change to a design, cannot be used."""


class GeometryError(FingertipError):
    """A part cannot be built, checked or written."""


class BoardError(FingertipError):
    """The values of the board cannot be computed, or its files cannot be written."""


class TraceError(FingertipError):
    """A recorded or simulated trace cannot be read or made."""


class SweepError(FingertipError):
    """A sweep file, or the folder of a sweep, cannot be used."""


class OutputError(FingertipError):
    """A result cannot be written."""


class StudioError(FingertipError):
    """The studio cannot be served."""


class MissingLibraryError(FingertipError):
    """A library of the system, or an optional package, is needed and is not installed."""


# Messages are written once, as they are typed on the command line. In Python, arguments of
# functions have the names of the options but for those below.

_RENAMED = {
    "calibrate": "calibrate_s",
    "column": "columns",
    "minutes": "negative_minutes",
    "set": "changes",
}
_UNITS = {"ms": "1e-3", "us": "1e-6", "ns": "1e-9"}
_PAIR = r"[^\s=]+=(?:'[^']*'|\[[^]]*\]|[^\s,;]*[^\s,;.])"
_VALUE = r"\d(?:[^\s;]*[^\s;,.])?|[A-Z]+\b|(?:ms|us|ns)\b|\w+(?:,\w+)+"
_OPTION = re.compile(
    rf"(?<![\w-])(?<!install )--(?P<name>[a-z][a-z-]*)"
    rf"(?: (?:(?P<pairs>{_PAIR}(?: --(?P=name) {_PAIR})*)|(?P<value>{_VALUE})))?(?P<more>(?= --))?"
)


def as_arguments(text: str) -> str:
    """Write options as arguments, such as `--rate-hz 2000` as `rate_hz=2000`.

    A fit is a function of its own. Commands in backquotes stay as they are.
    """
    text = text.replace("add --fit,", "call fit_design(design, changes),")
    pieces = re.split(r"(`[^`]*`)", text) if "--" in text else [text]
    return "".join(
        piece if piece.startswith("`") else _OPTION.sub(_argue, piece) for piece in pieces
    )


def _argue(match: re.Match[str]) -> str:
    """Write an option with its value as an argument."""
    option = match["name"]
    pairs = match["pairs"]
    value = match["value"]
    name = _RENAMED.get(option, option.replace("-", "_"))
    comma = "" if match["more"] is None else ","

    if pairs:
        entries = []
        for pair in pairs.split(f" --{option} "):
            key, _, word = pair.partition("=")
            entries.append(f'"{key}": {_literal(word)}')

        return f"{name}={{{', '.join(entries)}}}{comma}"

    if value is None:
        return f"{name}=True" if match.string.endswith("add ", 0, match.start()) else name

    begin, colon, end = value.partition(":")
    if colon:
        return f"{name}=({begin}, {end}){comma}"

    return f"{name}={_UNITS.get(value) or _literal(value)}{comma}"


def _literal(word: str) -> str:
    """Write a word of the command line as a literal of Python."""
    if re.fullmatch(r"-?[\d.]+(?:e[+-]?\d+)?|[A-Z]+|\[.*\]|'.*'", word):
        return word
    if "," in word:
        return f"[{', '.join(map(_literal, word.split(',')))}]"

    return {"true": "True", "false": "False"}.get(word, f'"{word}"')


_LARGEST = 10**308
F = TypeVar("F", bound=Callable[..., Any])
_KINDS = {
    "NoneType": "None",
    "Callable": "a function",
    "Iterable": "a list",
    "Sequence": "a list",
    "Collection": "a list",
    "Mapping": "a dict",
    "str": "a text",
    "Path": "a path",
    "int": "a whole number",
    "float": "a number",
    "bool": "True or False",
    "Design": 'a Design, such as Design.load("fsr400")',
    "SceneFile": 'a SceneFile, such as SceneFile.load("sliding_finger")',
    "Grid": "a Grid, such as Grid(16)",
    "ManipulationFile": 'a ManipulationFile, such as ManipulationFile.load("real_manipulation")',
}
"""Name of a type -> how a message asks for a value of it."""


def checked(function: F) -> F:
    """Refuse arguments of other types than a function, or the constructor of a class, declares.

    Lists are taken for tuples, and scalars of numpy for numbers. Types that are imported for type
    checkers only, and protocols, are not checked. Raises ArgumentError.
    """
    if isinstance(function, type):
        function.__init__ = checked(function.__init__)  # type: ignore[misc]
        return function

    signature = inspect.signature(function)
    hints = dict[str, Any]()
    for name, parameter in signature.parameters.items():
        with contextlib.suppress(NameError, TypeError):
            hint = eval(parameter.annotation, inspect.unwrap(function).__globals__)
            if not isinstance(hint, str):  # a type alias that numpy is not loaded for
                is_variadic = parameter.kind is parameter.VAR_POSITIONAL
                hints[name] = tuple[hint, ...] if is_variadic else hint  # type: ignore[valid-type]

    @functools.wraps(function)
    def call(*values: Any, **named: Any) -> Any:
        bound = signature.bind(*values, **named)
        for name, hint in hints.items():
            if name in bound.arguments:
                bound.arguments[name] = _fit(name, bound.arguments[name], hint)

        return function(*bound.args, **bound.kwargs)

    return cast("F", call)


def _fit(field: str, value: Any, hint: Any) -> Any:
    """Return a value as a type hint declares it."""
    if getattr(value, "ndim", None) == 0:  # a scalar of numpy, which a refusal need not load
        value = value.tolist()

    kinds = get_args(hint) if isinstance(hint, UnionType) else (hint,)
    for kind in kinds:
        plain = get_origin(kind) or kind
        if plain is tuple and type(value) is list:
            value = tuple(value)
        if plain is float and isinstance(value, int) and not -_LARGEST < value < _LARGEST:
            raise ArgumentError(
                Issue(field, f"is {quote_value(value)}, beyond every float; give a smaller number.")
            )
        if plain is Any or (plain is float and isinstance(value, int)):
            return value

        try:
            fits = isinstance(value, plain) and not (
                isinstance(value, bytes) and plain is not bytes
            )
        except TypeError:  # a protocol
            return value

        if fits:
            if plain is Callable or type(value) not in (list, tuple) or not get_args(kind):
                return value

            item_kind = get_args(kind)[0]
            return type(value)(
                _fit(f"{field}[{i}]", item, item_kind) for i, item in enumerate(value)
            )

    names = [getattr(kind, "__name__", str(kind)) for kind in reversed(kinds)]
    remedy = join_words([_KINDS.get(name, f"a {name}") for name in names], "or")
    message = f"is {quote_value(value)}, of type {type(value).__name__}; give {remedy}."
    raise ArgumentError(Issue(field, message))
