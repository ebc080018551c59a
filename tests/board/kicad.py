"""Run kicad-cli with a home folder of its own, and read its netlists."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from tests.oracles.sexpressions import children, parse, word
from tests.tools import require_tool

HOW_TO_INSTALL_KICAD = (
    "run `sh .ci/install-kicad` as root on Debian 12, or install KiCad 9 with "
    "its symbols and footprints"
)


def kicad_cli(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run kicad-cli in a folder. Its settings go to a folder beside that."""
    home = folder.parent / "kicad-home"
    home.mkdir(exist_ok=True)
    return subprocess.run(
        [require_tool("kicad-cli", HOW_TO_INSTALL_KICAD), *arguments],
        cwd=folder,
        env=os.environ | {"KICAD_CONFIG_HOME": str(home), "HOME": str(home)},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


Nets = dict[str, set[tuple[str, str]]]


def read_netlist(netlist: Path) -> tuple[Nets, dict[str, tuple[str, str]]]:
    """Read a netlist file: pins by net, and value and footprint by reference."""
    tree = parse(netlist.read_text("utf-8"))
    nets = {
        word(net, "name"): {
            (word(node, "ref"), word(node, "pin")) for node in children(net, "node")
        }
        for net in children(next(children(tree, "nets")), "net")
    }
    components = {
        word(c, "ref"): (word(c, "value"), word(c, "footprint"))
        for c in children(next(children(tree, "components")), "comp")
    }
    return nets, components
