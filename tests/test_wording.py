"""Docstrings and names follow CONTRIBUTING.md: what a machine
can check of plain engineering English.
"""

from __future__ import annotations

import ast
import importlib.util
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from fingertip.foundation.tables import read_rows
from tests.conftest import ROOT

SOURCES = sorted(
    [
        *(ROOT / "src").rglob("*.py"),
        *(ROOT / "tools").rglob("*.py"),
        *(ROOT / "benchmarks/peers").rglob("*.py"),
        *(ROOT / "benchmarks/slip").rglob("*.py"),
    ]
)
TESTS = sorted((ROOT / "tests").rglob("*.py"))

PREPOSITIONS = """
about above across after against along among around as at before behind below beneath beside besides between beyond by
despite down during except for from in inside into like near of off on onto out outside over per since through
throughout to toward towards under until up upon with within without
"""  # noqa: E501
CONJUNCTIONS = (
    "although and because but else if nor not or so than then though unless whether while"
)
RELATIVE_WORDS = "how that what when where which who whom whose why"
PRONOUNS = "again also here it its only same such their there these they this those"
NOT_FIRST = frozenset(f"{PREPOSITIONS} {CONJUNCTIONS} {RELATIVE_WORDS} {PRONOUNS}".split())
"""Words that no docstring begins with: a docstring begins with
the noun or verb of what it documents.
"""


def docstrings(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Line and text of each docstring of a module, those of constants and attributes included."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if not isinstance(body, list):
            continue
        documented = isinstance(
            node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
        )
        for before, statement in zip([None, *body], body, strict=False):
            follows = before is None if documented else False
            if not (follows or isinstance(before, ast.Assign | ast.AnnAssign)):
                continue
            if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
                text = statement.value.value
                if isinstance(text, str):
                    yield statement.lineno, text


def first_word(text: str) -> str:
    """First word of a text, in lower case, without punctuation or markup."""
    word = re.match(r"[A-Za-z']*", text.lstrip())
    # Markup, numbers and states such as ON are no words of this kind.
    return "" if word is None or (word[0].isupper() and len(word[0]) > 1) else word[0].lower()


def misplaced(path: Path) -> list[str]:
    """Docstrings of a file whose first word is none of a noun, a verb, an article or a number."""
    found = docstrings(ast.parse(path.read_text(encoding="utf-8")))
    return [
        f"{path.relative_to(ROOT)}:{line}: {text.splitlines()[0]}"
        for line, text in found
        if first_word(text) in NOT_FIRST
    ]


@pytest.mark.full
def test_docstrings_begin_with_a_noun_or_a_verb() -> None:
    wrong = [line for path in SOURCES for line in misplaced(path)]
    assert not wrong, "\n".join(wrong)


def test_modules_that_are_named_exist() -> None:
    """Dotted names of modules in docstrings and comments, as in `fingertip.cad.kernel`."""
    missing = []
    for path in [*SOURCES, *TESTS, *(ROOT / "benchmarks").glob("*.py")]:
        for name in re.findall(r"`(fingertip(?:\.[a-z_0-9]+)+)", path.read_text(encoding="utf-8")):
            module, _, attribute = name.rpartition(".")
            if not (exists(name) or (exists(module) and attribute in names_in(module))):
                missing.append(f"{path.relative_to(ROOT)}: {name}")
    assert not missing, "\n".join(missing)


def exists(name: str) -> bool:
    """Whether a module can be found; packages above it are imported."""
    try:
        return importlib.util.find_spec(name) is not None
    except ModuleNotFoundError:
        return False


def names_in(module: str) -> str:
    """Source text of a module."""
    spec = importlib.util.find_spec(module)
    return Path(spec.origin).read_text(encoding="utf-8") if spec and spec.origin else ""


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", "docs/architecture.md"])
def test_paths_in_the_developers_pages_exist(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    named = re.findall(
        r"`((?:src|tests|tools|params|benchmarks|docs|examples|\.ci|\.github|board|cad|calibration|casting|catalogues|cli|design|detection|documents|firmware|foundation|lab|models|page|pictures|sim|slip|studio|sweep|tasks)/[\w./-]*)`",
        text,
    )
    missing = [
        name
        for name in named
        if not ((ROOT / name).exists() or (ROOT / "src/fingertip" / name).exists())
    ]
    assert named
    assert not missing
    assert "@@" not in text


INSTRUCTIONS = [
    "README.md",
    *(f"docs/{name}.md" for name in ("index", "install", "tutorial", "casting", "sets", "sensor")),
]
"""Pages to be followed step by step; the casting sheet is another."""


def sentences(text: str) -> Iterator[list[str]]:
    """Words of each sentence of a Markdown page, without tables,
    headings, pictures, quotations and blocks of code.
    """
    text = re.sub(r"```.*?```|!\[[^\]]*\]\([^)]*\)", "\n\n", text, flags=re.DOTALL)
    text = re.sub(r"^(?:\||#|>).*$", "", text, flags=re.MULTILINE)
    text = re.sub(r"`[^`]*`", "x", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text))
    for block in re.split(r"\n\s*\n|\n(?=\s*(?:- |\d+\. ))", text):
        for sentence in re.split(r"(?<=[.?!])\s+", re.sub(r"^\s*(?:- |\d+\. )", "", block)):
            if re.search(r"\w", sentence):
                yield sentence.split()


@pytest.mark.parametrize(
    "page", [*INSTRUCTIONS, "tests/documents/approved/adult_finger_casting.md"]
)
def test_instructions_have_short_sentences(page: str) -> None:
    found = list(sentences((ROOT / page).read_text(encoding="utf-8")))
    assert sum(map(len, found)) <= 16 * len(found)
    assert [" ".join(words) for words in found if len(words) > 30] == []


def test_words_of_the_page_stand_in_the_manual() -> None:
    manual = (ROOT / "docs/reference.md").read_text(encoding="utf-8").replace("`", "")
    rows = [row.values() for row in read_rows(ROOT / "src/fingertip/page/assets/words.csv")]
    assert len(rows) > 10
    assert [row for row in rows if f"| {' | '.join(row)} |" not in manual] == []
