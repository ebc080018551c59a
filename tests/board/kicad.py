"""Runs kicad-cli with a home of its own, and reads what it writes."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from tests.board.expressions import children, parse
from tests.tools import require_tool

HOW = "run `sh .ci/install-kicad` as root on Debian 12, or install KiCad 9 with its symbols and footprints"


def kicad_cli(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """kicad-cli in this folder; its settings stay there too."""
    home = folder.parent / "kicad-home"
    home.mkdir(exist_ok=True)
    return subprocess.run(
        [require_tool("kicad-cli", HOW), *arguments],
        cwd=folder, env=os.environ | {"KICAD_CONFIG_HOME": str(home), "HOME": str(home)},
        capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip


Nets = dict[str, set[tuple[str, str]]]


def nets_and_parts(netlist: Path) -> tuple[Nets, dict[str, tuple[str, str]]]:
    """Net -> its pins, and reference -> value and footprint, of a netlist file."""
    tree = parse(netlist.read_text("utf-8"))
    nets = {
        next(children(net, "name"))[1]: {
            (next(children(node, "ref"))[1], next(children(node, "pin"))[1]) for node in children(net, "node")
        }
        for net in children(next(children(tree, "nets")), "net")
    }
    parts = {
        next(children(c, "ref"))[1]: (next(children(c, "value"))[1], next(children(c, "footprint"))[1])
        for c in children(next(children(tree, "components")), "comp")
    }
    return nets, parts
