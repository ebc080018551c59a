"""Agreement of install.sh, constraints.txt and pyproject.toml about what is installed. No test needs the network."""

from __future__ import annotations

import mmap
import re
import struct
import subprocess
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest

from tests.tools import require_tool

ROOT = Path(__file__).resolve().parents[1]
INSTALL = ROOT / "install.sh"
CONSTRAINTS = ROOT / "constraints.txt"
SCRIPTS = [INSTALL, *sorted(path for path in (ROOT / ".ci").iterdir() if path.is_file() and not path.suffix)]


def canonical(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def lines() -> list[str]:
    text = CONSTRAINTS.read_text(encoding="utf-8")
    return [line for line in text.splitlines() if line and not line.startswith("#")]


def pins() -> dict[str, str]:
    return {canonical(name): version for name, version in (line.split("==") for line in lines())}


def named_dependencies() -> list[str]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"].values()
    requirements = [*project["dependencies"], *(entry for extra in extras for entry in extra)]
    names = [re.match(r"[\w.-]+", requirement) for requirement in requirements]
    return [canonical(name.group()) for name in names if name]


def test_constraints_are_plain_pins() -> None:
    wrong = [line for line in lines() if not re.fullmatch(r"[A-Za-z0-9][\w.-]*==[0-9][0-9A-Za-z.]*", line)]
    assert wrong == []


def test_constraints_name_no_place() -> None:
    text = CONSTRAINTS.read_text(encoding="utf-8")
    assert "://" not in text
    assert not re.search(r"(^|\s)[/~@\\]", text)


def test_constraints_are_sorted_and_unique() -> None:
    names = [canonical(line.split("==")[0]) for line in lines()]
    assert names == sorted(set(names))


@pytest.mark.parametrize("name", named_dependencies())
def test_every_dependency_is_pinned(name: str) -> None:
    assert name in pins()


def test_installed_versions_are_the_pinned_ones() -> None:
    if Path(sys.prefix).resolve() != ROOT / ".venv":
        pytest.skip(f"{sys.prefix} was not made by install.sh: its versions are anybody's")
    installed = {canonical(d.metadata["Name"]): d.version for d in metadata.distributions()}
    wrong = {name: (installed[name], pin) for name, pin in pins().items() if installed.get(name, pin) != pin}
    assert wrong == {}
    unpinned = set(installed) - set(pins()) - {"fingertip", "pip", "setuptools"}
    assert unpinned == set(), "add these to constraints.txt"


def test_every_dependency_has_a_lowest_version() -> None:
    command = [sys.executable, str(ROOT / ".ci/lowest.py"), str(ROOT / "pyproject.toml")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert {canonical(line.split("==")[0]) for line in done.stdout.splitlines()} == set(named_dependencies())


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_script_parses(script: Path) -> None:
    first = script.read_text(encoding="utf-8").splitlines()[0]
    shell = first.removeprefix("#!/bin/")
    assert shell in ("sh", "bash")
    program = require_tool(shell, f"install {shell}")
    done = subprocess.run([program, "-n", str(script)], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_install_refuses_an_unknown_word() -> None:
    done = subprocess.run(["sh", str(INSTALL), "tests"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == "install: the only word it takes is 'test'\n"


def test_install_and_the_step_error_name_the_same_packages() -> None:
    installed = re.search(r'^packages="([^"]+)"$', INSTALL.read_text(encoding="utf-8"), re.MULTILINE)
    source = (ROOT / "src/fingertip/cad/kernel/brep.py").read_text(encoding="utf-8")
    named = re.search(r"apt-get install ([a-z0-9.+ -]+)", source)
    assert installed is not None
    assert named is not None
    assert named.group(1).split() == installed.group(1).split()


def libraries_asked_for(path: Path) -> set[str]:
    """The DT_NEEDED entries of a 64-bit little-endian ELF file."""
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as elf:
        assert elf[:6] == b"\x7fELF\2\1"
        (table,) = struct.unpack_from("<Q", elf, 32)
        size, count = struct.unpack_from("<HH", elf, 54)
        segments = [struct.unpack_from("<IIQQQQ", elf, table + i * size) for i in range(count)]
        (dynamic,) = [(offset, length) for kind, _, offset, _, _, length in segments if kind == 2]
        entries = list(struct.iter_unpack("<qQ", elf[dynamic[0] : sum(dynamic)]))
        (strings,) = [value for tag, value in entries if tag == 5]
        (strings,) = [
            strings - address + offset
            for kind, _, offset, address, _, length in segments
            if kind == 1 and address <= strings < address + length
        ]
        names = [strings + value for tag, value in entries if tag == 1]
        return {elf[start : elf.find(b"\0", start)].decode() for start in names}


@pytest.mark.skipif(sys.platform != "linux", reason="the wheels of other systems bring all they need")
def test_install_looks_for_the_libraries_that_the_wheels_ask_for() -> None:
    """Libraries that cadquery-ocp and vtk link to, except for those they contain and those that Python itself needs."""
    if metadata.version("cadquery-ocp") != pins()["cadquery-ocp"]:
        pytest.skip("install.sh names the libraries of the pinned wheels, and another version is installed")
    wheels = ("cadquery-ocp", "vtk")
    paths = [Path(str(f.locate())) for wheel in wheels for f in metadata.files(wheel) or [] if ".so" in f.name]
    brought = {path.name for path in paths}
    asked = set().union(*map(libraries_asked_for, paths)) - brought
    everywhere = re.compile(r"ld-linux.*|lib(c|m|dl|rt|pthread|gcc_s|stdc\+\+|z)\.so\.\d")
    listed = re.search(r'^libraries="([^"]+)"$', INSTALL.read_text(encoding="utf-8"), re.MULTILINE)
    assert listed is not None
    assert {name for name in asked if not everywhere.fullmatch(name)} == set(listed.group(1).split())
