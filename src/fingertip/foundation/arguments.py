"""Messages in the words of Python: options of the command line become arguments of functions.

Messages are written once, as they are typed on the command line. Both have the same names but for those below.
"""

from __future__ import annotations

import re

_RENAMED = {"calibrate": "calibrate_s", "column": "columns", "minutes": "negative_minutes", "set": "changes"}
_UNITS = {"ms": "1e-3", "us": "1e-6", "ns": "1e-9"}
_PAIR = r"[^\s=]+=(?:'[^']*'|\[[^]]*\]|[^\s,;]*[^\s,;.])"
_VALUE = r"\d(?:[^\s;]*[^\s;,.])?|[A-Z]+\b|(?:ms|us|ns)\b|\w+(?:,\w+)+"
_OPTION = re.compile(
    rf"(?<![\w-])(?<!install )--(?P<name>[a-z][a-z-]*)"
    rf"(?: (?:(?P<pairs>{_PAIR}(?: --(?P=name) {_PAIR})*)|(?P<value>{_VALUE})))?(?P<more>(?= --))?"
)


def as_arguments(text: str) -> str:
    """Write options as arguments, such as `--rate-hz 2000` as `rate_hz=2000`; commands in backquotes stay."""
    pieces = re.split(r"(`[^`]*`)", text) if "--" in text else [text]
    return "".join(piece if piece.startswith("`") else _OPTION.sub(_argue, piece) for piece in pieces)


def _argue(found: re.Match[str]) -> str:
    option, pairs, value = found["name"], found["pairs"], found["value"]
    name, comma = _RENAMED.get(option, option.replace("-", "_")), "" if found["more"] is None else ","
    if pairs:
        entries = (pair.partition("=") for pair in pairs.split(f" --{option} "))
        return f"{name}={{" + ", ".join(f'"{key}": {_literal(word)}' for key, _, word in entries) + f"}}{comma}"
    if value is None:
        return f"{name}=True" if found.string.endswith("add ", 0, found.start()) else name
    begin, colon, end = value.partition(":")
    return f"{name}=({begin}, {end}){comma}" if colon else f"{name}={_UNITS.get(value) or _literal(value)}{comma}"


def _literal(word: str) -> str:
    if re.fullmatch(r"-?[\d.]+(?:e[+-]?\d+)?|[A-Z]+|\[.*\]|'.*'", word):
        return word
    if "," in word:
        return f"[{', '.join(map(_literal, word.split(',')))}]"
    return {"true": "True", "false": "False"}.get(word, f'"{word}"')
