"""The drawing of the layers in docs/architecture.md is what the contracts enforce and what the
source imports; no module names another in a string.
"""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Container, Iterable, Iterator
from itertools import product

import grimp
import pytest

from tests.conftest import ROOT

PAGE = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
DRAWN = {
    words[0]: words[2:]
    for line in PAGE.split("```text\n")[1].split("```")[0].splitlines()
    if (words := line.split())
}


@pytest.fixture(scope="module")
def imports() -> dict[str, set[str]]:
    """Folder -> folders that its modules import."""
    graph = grimp.build_graph("fingertip", cache_dir=None)
    graph.remove_module("fingertip.models.program_types")  # types of the program
    found: dict[str, set[str]] = {folder: set() for folder in DRAWN}
    for module in graph.modules:
        for other in graph.find_modules_directly_imported_by(module):
            one, two = (
                name.removeprefix("fingertip").lstrip(".").partition(".")[0]
                for name in (module, other)
            )
            if one in found and two and one != two:
                found[one].add(two)
    return found


def reach(folder: str) -> set[str]:
    return {end for arrow in DRAWN[folder] for end in {arrow, *reach(arrow)}}


def test_the_drawing_has_every_folder_and_no_other() -> None:
    folders = {path.parent.name for path in (ROOT / "src/fingertip").glob("*/__init__.py")}
    assert set(DRAWN) == folders
    assert set(re.findall(r"^\| `(\w+)/` \|", PAGE, re.MULTILINE)) == folders


def test_arrows_are_imports_and_lead_to_all_imports(imports: dict[str, set[str]]) -> None:
    for folder, arrows in DRAWN.items():
        assert set(arrows) <= imports[folder], f"{folder}: an arrow without an import"
        assert imports[folder] <= reach(folder), f"{folder}: an import without an arrow"
        assert all(one not in reach(two) for one, two in product(arrows, repeat=2)), (
            f"{folder}: an arrow too many"
        )


def test_the_contract_has_the_order_of_the_drawing() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    layers = next(contract["layers"] for contract in contracts if contract["type"] == "layers")
    ranks = {name: rank for rank, layer in enumerate(layers) for name in re.findall(r"\w+", layer)}
    assert set(ranks) == {*DRAWN, "__main__"}
    assert all(ranks[folder] < ranks[arrow] for folder, arrows in DRAWN.items() for arrow in arrows)
    # Siblings of one layer must not import each other: the drawing has no arrow between them
    # either.
    assert [ranks[name] for name in DRAWN] == sorted(ranks[name] for name in DRAWN)


def read_modules() -> dict[str, ast.Module]:
    """Module -> its syntax tree."""
    folder = ROOT / "src"
    modules = {}
    for path in folder.glob("fingertip/**/*.py"):
        name = ".".join(path.relative_to(folder).with_suffix("").parts)
        modules[name.removesuffix(".__init__")] = ast.parse(path.read_text(encoding="utf-8"))

    return modules


def list_texts(tree: ast.Module) -> Iterator[str]:
    """List the strings of a module that are no docstrings."""
    holders = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
    ]
    docstrings = {
        id(statement.value)
        for holder in holders
        for statement in holder.body
        if isinstance(statement, ast.Expr)
    }
    for node in ast.walk(tree):
        if not isinstance(node, ast.Constant) or id(node) in docstrings:
            continue

        if isinstance(node.value, str):
            yield node.value


def find_named(texts: Iterable[str], modules: Container[str]) -> set[str]:
    """Find the modules of the package that texts name, such as `slip.detection_results` or
    `fingertip.slip.detection_results:draw`.
    """
    words = {word.strip(".") for text in texts for word in re.findall(r"[\w.]+", text)}
    dotted = {word.removeprefix("fingertip.") for word in words if "." in word}
    return {f"fingertip.{word}" for word in dotted if f"fingertip.{word}" in modules}


def test_a_module_named_in_a_string_is_found() -> None:
    """The next two tests could not fail without it."""
    modules = {"fingertip.slip.detection_results", "fingertip.slip"}
    for text in ("{}", "fingertip.{}", "fingertip.{}:draw", "see {}."):
        texts = [text.format("slip.detection_results")]
        assert find_named(texts, modules) == {"fingertip.slip.detection_results"}
    assert find_named(["slip", "fingertip.slips", "report.py"], modules) == set()


@pytest.mark.second
def test_no_module_below_the_commands_names_another_in_a_string() -> None:
    """A name in a string is an import that no contract sees."""
    modules = read_modules()
    above = ("fingertip", "fingertip.__main__")
    identifier = (
        "fingertip.board.kicad.netlist"  # its string begins the identifiers of KiCad's files
    )
    named = {
        module: found
        for module, tree in modules.items()
        if module not in (*above, identifier) and not module.startswith("fingertip.cli")
        if (found := find_named(list_texts(tree), modules))
    }
    assert named == {}


@pytest.mark.second
def test_no_module_reaches_itself_by_imports_and_names() -> None:
    modules = read_modules()
    graph = grimp.build_graph("fingertip", cache_dir=None)
    graph.remove_module("fingertip")  # its names are imported for types alone
    for module, tree in modules.items():
        for named in find_named(list_texts(tree), modules) if module != "fingertip" else ():
            graph.add_import(importer=module, imported=named)

    in_a_circle = {
        module
        for module in graph.modules
        for imported in graph.find_modules_directly_imported_by(module)
        if graph.chain_exists(importer=imported, imported=module)
    }
    assert in_a_circle == set()


def test_models_import_the_standard_library_and_themselves_alone() -> None:
    """The scripts of `build --formats cq` carry a copy of them. What is for type checkers alone is
    not imported there.
    """
    wrong = []
    for path in (ROOT / "src/fingertip/models").glob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for_types = {
            node
            for block in ast.walk(tree)
            if isinstance(block, ast.If) and ast.unparse(block.test) == "TYPE_CHECKING"
            for node in ast.walk(block)
        }
        allowed = {"cadquery", "OCP"} if path.name == "workplanes.py" else set()
        for node in set(ast.walk(tree)) - for_types:
            if isinstance(node, ast.Import):
                found = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                found = [str(node.module)]
            else:
                continue
            roots = {name.partition(".")[0] for name in found}
            wrong += [(path.name, root) for root in roots - allowed - sys.stdlib_module_names]
    assert not wrong
