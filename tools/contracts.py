"""Contract of import-linter: the modules of a folder and its subfolders import in one direction.

The modules that lie in a folder count as one. They may import a subfolder, or be imported by it,
but not both. The contract `acyclic_siblings` of import-linter compares single modules, so it misses
a folder whose modules lie partly above and partly below a subfolder.
"""

from __future__ import annotations

from importlib.util import find_spec

from grimp import ImportGraph
from importlinter.application import output
from importlinter.domain.contract import Contract, ContractCheck

Import = tuple[str, str]


class FoldersAndSubfolders(Contract):
    """The modules of each folder, taken as one, and its subfolders form no cycle of imports."""

    type_name = "folders_and_subfolders"

    def check(self, graph: ImportGraph, verbose: bool) -> ContractCheck:
        """Look at every folder of the graph."""
        broken: dict[str, list[Import]] = {}
        for folder in sorted(graph.modules):
            broken |= _find_both_ways(graph, folder)

        return ContractCheck(kept=not broken, metadata={"broken": broken})

    def render_broken_contract(self, check: ContractCheck) -> None:
        """Print each pair that imports both ways, and the imports of the direction that
        has fewer.
        """
        for pair, imports in check.metadata["broken"].items():
            output.print_error(f"{pair} import each other; the fewer imports are:")
            for importer, imported in imports:
                output.indent_cursor()
                output.print_error(f"{importer} -> {imported}")


def _is_package(module: str) -> bool:
    """Return whether a module without modules below it is the only one of its folder."""
    spec = find_spec(module)
    return spec is not None and spec.submodule_search_locations is not None


def _find_both_ways(graph: ImportGraph, folder: str) -> dict[str, list[Import]]:
    children = graph.find_children(folder)
    subfolders = {child for child in children if graph.find_children(child) or _is_package(child)}
    loose = children - subfolders
    found = {}

    for subfolder in subfolders:
        below = {subfolder, *graph.find_descendants(subfolder)}
        down = list[Import]()
        up = list[Import]()

        for module in loose:
            down += [
                (module, other) for other in graph.find_modules_directly_imported_by(module) & below
            ]
            up += [
                (other, module) for other in graph.find_modules_that_directly_import(module) & below
            ]

        if down and up:
            found[f"the modules of {folder} and {subfolder}"] = sorted(
                down if len(down) < len(up) else up
            )

    return found
