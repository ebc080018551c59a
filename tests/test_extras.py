"""A core installation: what needs an extra says so in one sentence
with the command, and everything else works.
"""

from __future__ import annotations

import ast
import contextlib
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import fingertip
from fingertip.cad.files.part_formats import default_formats
from fingertip.design import Design
from fingertip.foundation import extras
from fingertip.foundation.display import new_figure
from fingertip.foundation.errors import MissingLibraryError
from fingertip.lab import validation as campaign
from fingertip.sweep.sweep_plan import SweepPlan
from fingertip.tasks.build import build, find_formats
from tests.conftest import ROOT, design_file, run_fingertip, run_python

DESIGN = str(design_file("fsr400"))
STEP = (
    "formats: step needs the package cadquery, which is not installed; "
    'pip install "fingertip-kit[cadquery]", or leave step out with formats=["stl", "3mf"].'
)


@pytest.mark.usefixtures("core")
def test_build_makes_stl_and_3mf_and_says_what_step_needs(tmp_path: Path) -> None:
    done = run_fingertip("build", DESIGN, "--parts", "bone", "--out", tmp_path / "out")
    assert done.returncode == 0
    assert {path.suffix for path in (tmp_path / "out").glob("bone.*")} == {".stl", ".3mf"}
    sentence = (
        "left out: STEP files and checks against exact solids; pip install "
        '"fingertip-kit[cadquery]" adds them'
    )
    assert done.stderr == f"{sentence}\n"
    messages: list[str] = []
    found = build(Design(), tmp_path / "python", parts=["bone"], progress=messages.append)
    assert dict(found.parts[0].files) == {"stl": "bone.stl", "3mf": "bone.3mf"}
    assert messages.count(sentence) == 1
    with pytest.raises(MissingLibraryError) as caught:
        build(Design(), tmp_path / "step", formats=default_formats())
    assert str(caught.value) == STEP
    assert not (tmp_path / "step").exists()


@pytest.mark.usefixtures("core")
def test_validation_leaves_its_plots_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def files(with_plots: bool) -> dict[str, bytes]:
        asked.append(with_plots)
        return {"validation.json": b"{}"}

    result = SimpleNamespace(
        files=files, as_data=dict, as_text=lambda: "", as_verdict=lambda: "", passed=True
    )
    monkeypatch.setattr(campaign, "validate", lambda *_, **__: result)
    done = run_fingertip("validate", DESIGN, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert asked == [False]
    assert [line for line in done.stderr.splitlines() if "pip" in line] == [
        "left out: plots and compiled loops (20 times faster); pip install "
        '"fingertip-kit[plots,fast]" adds them'
    ]


@pytest.mark.usefixtures("core")
def test_functions_for_python_name_the_extra() -> None:
    with pytest.raises(
        MissingLibraryError,
        match=r'^part_solid: needs the package cadquery,.*"fingertip-kit\[cadquery\]"\.$',
    ):
        fingertip.part_solid(Design(), "bone")
    with pytest.raises(
        MissingLibraryError,
        match=r'^part_trimesh: .* trimesh.*"fingertip-kit\[mesh\]", or use part_mesh\.$',
    ):
        fingertip.part_trimesh(Design(), "bone")
    with pytest.raises(
        MissingLibraryError, match=r'^Trace.to_dataframe: .* pandas.*"fingertip-kit\[frames\]"'
    ):
        fingertip.Trace(np.zeros(1), np.zeros(1)).to_dataframe()
    with pytest.raises(
        MissingLibraryError,
        match=r'^plot: needs the package matplotlib.*"fingertip-kit\[plots\]"\.$',
    ):
        new_figure(1, 1)


@pytest.mark.usefixtures("core")
def test_samples_of_a_sweep_made_elsewhere_cannot_be_repeated() -> None:
    text = (
        'outputs = ["q"]\nsampling = "sobol"\npoints = 8\naxes = {board.cutoff_hz = {low = 60, '
        "high = 75}}\n"
    )
    plan = SweepPlan.from_toml(text)  # as a worker reads it, which needs no samples
    with pytest.raises(MissingLibraryError, match=r"sampling: sobol needs the package scipy"):
        plan.point(0)


def test_package_that_cannot_be_imported_is_not_called_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert find_formats(pytest.fail) == default_formats()
    extras.require("field", *extras.EXTRAS)
    (tmp_path / "trimesh.py").write_text("import no_such_module\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "trimesh", raising=False)
    with pytest.raises(MissingLibraryError) as caught:
        extras.load("trimesh", "field")
    reason = "No module named 'no_such_module'"
    command = extras.install_command("trimesh")
    assert str(caught.value) == (
        f"field: needs the package trimesh, which cannot be imported ({reason}); {command}."
    )


def run_venv(folder: Path, shebang: str = "", path: str = "") -> str:
    """Return how packages are installed from a folder with the Python
    of an environment, and with this pip in it.
    """
    for place in (folder / ".venv/bin", folder / "other"):
        place.mkdir(parents=True, exist_ok=True)
        (place / "pip").write_text(f"#!{shebang}\n", encoding="utf-8")
        (place / "pip").chmod(0o755)
    python = folder / ".venv/bin/python"
    with contextlib.chdir(folder), pytest.MonkeyPatch.context() as patch:
        if not python.is_symlink():
            python.symlink_to(sys.executable)
        patch.setattr(sys, "executable", str(python))
        patch.setenv("PATH", path)
        return extras.find_pip()


def test_hints_name_the_pip_of_the_running_interpreter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    python = str(tmp_path / ".venv/bin/python")
    folder = str(tmp_path / ".venv/bin")
    monkeypatch.setattr(extras, "is_installed", lambda module: True)
    assert run_venv(tmp_path, python, folder) == "pip install"
    assert run_venv(tmp_path, python) == ".venv/bin/python -m pip install"
    assert run_venv(tmp_path, python, str(tmp_path / "other")) == ".venv/bin/python -m pip install"
    assert run_venv(tmp_path, "/bin/sh", folder) == ".venv/bin/python -m pip install"
    with monkeypatch.context() as elsewhere:
        elsewhere.setattr(Path, "cwd", lambda: Path("/nowhere"))
        assert (
            run_venv(tmp_path / "a b", python)
            == f"'{tmp_path}/a b/.venv/bin/python' -m pip install"
        )
    monkeypatch.setattr(extras, "is_installed", lambda module: module != "pip")
    assert (
        run_venv(tmp_path, python, folder)
        == ".venv/bin/python -m ensurepip && .venv/bin/python -m pip install"
    )
    (tmp_path / "other/uv").touch(mode=0o755)
    assert (
        run_venv(tmp_path, python, str(tmp_path / "other"))
        == "uv pip install --python .venv/bin/python"
    )


IMPORT_EVERYTHING = """
import importlib, pkgutil, sys
from fingertip.foundation.extras import EXTRAS

class Finder:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in EXTRAS:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Finder())
import fingertip
refused = []
for module in pkgutil.walk_packages(fingertip.__path__, "fingertip."):
    if module.name == "fingertip.__main__":
        continue
    try:
        importlib.import_module(module.name)
    except Exception as error:
        refused.append(f"{module.name}: {type(error).__name__}")
print(refused)
"""


@pytest.mark.full
def test_only_the_exact_kernel_needs_an_extra_to_be_imported() -> None:
    done = run_python("-c", IMPORT_EVERYTHING)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == str(
        [
            "fingertip.cad.files.step_writer: ModuleNotFoundError",
            "fingertip.cad.kernel.brep: MissingLibraryError",
            "fingertip.cad.kernel.occ: ModuleNotFoundError",
            "fingertip.models.workplanes: ModuleNotFoundError",
            "fingertip.pictures.drawing.hidden_lines: ModuleNotFoundError",
        ]
    )


def find_imports(path: Path) -> Iterator[str]:
    """Find the packages that a module imports, by a statement or through `extras.load`."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module.partition(".")[0]
        elif isinstance(node, ast.Call) and ast.unparse(node.func) in (
            "extras.load",
            "load",
            "importlib.import_module",
        ):
            text = ast.unparse(node.args[0])
            named = re.match(r"f?'(\w+)", text)
            if named:
                yield named[1]


PACKAGES = {"PIL": "pillow", "markdown_it": "markdown-it-py"}
"""Module -> package of the core that brings it, where their names differ."""
BROUGHT_ALONG = {"click", "pydantic_core", "typing_extensions"}
"""Modules that packages of the core always bring."""


@pytest.mark.second
def test_every_package_that_the_source_imports_is_of_the_core_or_of_an_extra() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    core = {re.split(r"[^\w-]", line)[0].lower() for line in project["dependencies"]}

    imported = {name for path in (ROOT / "src").rglob("*.py") for name in find_imports(path)}
    others = imported - sys.stdlib_module_names - {"fingertip"} - BROUGHT_ALONG
    of_core = {name for name in others if PACKAGES.get(name, name).lower() in core}
    assert {PACKAGES.get(name, name).lower() for name in of_core} == core, (
        "each package of the core is used"
    )
    assert others - of_core <= set(extras.EXTRAS), (
        "name the extra that installs the package in EXTRAS"
    )
