"""Faults of staleness and exchange that CI must notice in a folder
of parts, made by hand, one at a time.
"""

from __future__ import annotations

import io
import json
import shutil
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from fingertip import Design, make
from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.verification.mesh_files import check_mesh_file, describe_mesh_cause
from fingertip.foundation.output_set import MANIFEST, hash_file
from fingertip.tasks.build import build
from fingertip.tasks.part_folder import compare_folder
from tests.conftest import run_fingertip

NAME = "first_finger"

pytestmark = pytest.mark.second


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder that `make` wrote, without STEP files."""
    folder = tmp_path_factory.mktemp("parts") / NAME
    assert make(Design.load(NAME), folder, formats=["stl", "3mf"]).parts.passed
    return folder


@pytest.fixture(scope="module")
def other(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Parts of another design."""
    folder = tmp_path_factory.mktemp("other") / "wider"
    wider = Design.load(NAME, changes=["skin.width_mm=19.4", "name=wider"])
    assert build(wider, folder, formats=["stl", "3mf"]).passed
    return folder


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    """Copy of the folder, for one fault."""
    return Path(shutil.copytree(made, tmp_path / NAME))


def move_mesh(path: Path, change: Callable[[np.ndarray], np.ndarray]) -> None:
    """Move the corners of an STL file."""
    mesh = stl.from_bytes(path.read_bytes())
    path.write_bytes(stl.to_bytes(Mesh(change(mesh.vertices), mesh.triangles), path.stem))


def edit_3mf(path: Path) -> None:
    """Move one corner of a 3MF file by a micrometre, and pack it again."""
    with zipfile.ZipFile(path) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    model = next(name for name in contents if name.endswith(".model"))
    contents[model] = contents[model].replace(b'x="', b'x="1', 1)
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name, data in contents.items():
            archive.writestr(name, data)
    path.write_bytes(packed.getvalue())


def edit_text(path: Path) -> None:
    path.write_text(path.read_text(encoding="utf-8") + "\n<!-- edited -->\n", encoding="utf-8")


def forget_program(folder: Path) -> None:
    manifest = json.loads((folder / MANIFEST).read_text())
    manifest["program"] = "0" * 64
    (folder / MANIFEST).write_text(json.dumps(manifest))


@dataclass(frozen=True)
class Fault:
    """Fault in a folder: what makes it, from the folder and one of
    another design, and what is said of it.
    """

    cause: Callable[[Path, Path], object]
    said: str


FAULTS = {
    "version": Fault(
        lambda folder, other: forget_program(folder), "made by another version of this program"
    ),
    "part": Fault(
        lambda folder, other: shutil.copy(other / "bone.stl", folder), "bone.stl: was changed"
    ),
    "half": Fault(
        lambda folder, other: shutil.copy(other / "mold_dorsal.stl", folder),
        "mold_dorsal.stl: was changed",
    ),
    "unit": Fault(
        lambda folder, other: move_mesh(folder / "bone.stl", lambda v: v / 25.4),
        "bone.stl: was changed",
    ),
    "scale": Fault(
        lambda folder, other: move_mesh(folder / "bone.stl", lambda v: v * 1.01),
        "bone.stl: was changed",
    ),
    "truncated file": Fault(
        lambda folder, other: (folder / "bone.stl").write_bytes(
            (folder / "bone.stl").read_bytes()[:-25]
        ),
        "bone.stl: was changed",
    ),
    "renamed file": Fault(
        lambda folder, other: (folder / "bone.stl").rename(folder / "bone_new.stl"),
        "bone.stl: is missing",
    ),
    "edited 3MF": Fault(
        lambda folder, other: edit_3mf(folder / "skin.3mf"), "skin.3mf: was changed"
    ),
    "missing part": Fault(
        lambda folder, other: (folder / "core.stl").unlink(), "core.stl: is missing"
    ),
    "shifted half": Fault(
        lambda folder, other: move_mesh(
            folder / "mold_dorsal.stl", lambda v: v + np.array([0.4, 0, 0])
        ),
        "mold_dorsal.stl: was changed",
    ),
    "page": Fault(
        lambda folder, other: edit_text(folder / "index.html"), "index.html: was changed"
    ),
    "netlist": Fault(
        lambda folder, other: edit_text(folder / "board/slip_filter.net"),
        "slip_filter.net: was changed",
    ),
    "print": Fault(
        lambda folder, other: shutil.copy(other / "print/bone.stl", folder / "print"),
        "print/bone.stl",
    ),
}


def test_unchanged_folder_is_the_design_s(folder: Path) -> None:
    done = run_fingertip("build", NAME, "--check", "--out", folder)
    assert (done.returncode, done.stderr) == (0, "")
    assert "all are as written" in done.stdout


@pytest.mark.every_case
@pytest.mark.parametrize("name", FAULTS)
def test_fault_in_a_folder_is_noticed(name: str, folder: Path, other: Path) -> None:
    fault = FAULTS[name]
    fault.cause(folder, other)
    done = run_fingertip("build", NAME, "--check", "--out", folder)
    assert done.returncode == 1
    assert fault.said in done.stdout
    force = "" if name == "version" else " --force"
    assert (
        done.stdout.splitlines()[-1]
        == f"next: fingertip make {NAME} --formats stl,3mf{force} --out {folder}"
    )


def test_changed_design_with_the_old_folder_is_noticed_and_named(folder: Path) -> None:
    done = run_fingertip("build", NAME, "--set", "skin.width_mm=19.4", "--check", "--out", folder)
    assert done.returncode == 1
    assert "skin.width_mm: 19.4 in the design, 19.0 in the folder" in done.stdout


def test_folder_of_another_design_is_noticed(other: Path) -> None:
    done = run_fingertip("build", NAME, "--check", "--out", other, "--json")
    assert done.returncode == 1
    (difference,) = json.loads(done.stdout)["differences"]
    assert "holds the parts of 'wider', not of first_finger" in difference


STALE = (
    "bone.groove_depth_mm=0.7",
    "bone.channel_diameter_mm=2.6",
    "mold.engraving_depth_mm=0.4",
    "name=other_name",
)
"""Changes of a design that leave the outer size of the part."""


@pytest.mark.full
@pytest.mark.parametrize(
    ("change", "part"), [*zip(STALE, ("bone", "bone", "mold_palmar", "core"), strict=True)]
)
def test_stale_part_of_the_same_outer_size_is_noticed(
    change: str, part: str, tmp_path: Path
) -> None:
    stale = Design.load("fsr400", changes=[change])
    build(stale, tmp_path, parts=[part], formats=["stl"])
    assert check_mesh_file(tmp_path / f"{part}.stl", stale).passed
    assert not check_mesh_file(tmp_path / f"{part}.stl", Design.load("fsr400")).passed


def test_print_files_without_their_manifest_are_compared(folder: Path, other: Path) -> None:
    (folder / "print" / MANIFEST).unlink()
    assert run_fingertip("build", NAME, "--check", "--out", folder).returncode == 0
    shutil.copy(other / "print/bone.stl", folder / "print")
    done = run_fingertip("build", NAME, "--check", "--out", folder)
    assert done.returncode == 1
    assert "print/bone.stl: is not the file of" in done.stdout


def test_parts_that_were_not_made_again_are_no_proof(folder: Path, other: Path) -> None:
    """A report of a partial build lists a part; the others must be made again all the same."""
    forget_program(folder)
    report = json.loads((folder / "report.json").read_text())
    report["parts"] = {"bone": report["parts"]["bone"]}
    (folder / "report.json").write_text(json.dumps(report))
    shutil.copy(other / "skin.stl", folder)
    manifest = json.loads((folder / MANIFEST).read_text())
    manifest["files"] |= {name: hash_file(folder / name) for name in ("skin.stl", "report.json")}
    (folder / MANIFEST).write_text(json.dumps(manifest))
    done = run_fingertip("build", NAME, "--check", "--verify", "--out", folder)
    assert done.returncode == 1
    assert "skin.stl: differs from what this design gives" in done.stdout


@pytest.mark.every_case
@pytest.mark.parametrize(
    "report", ["", "[]", "{}", '{"tolerance_mm": "0.05"}', '{"tolerance_mm": 1e-9}']
)
def test_report_of_another_program_is_a_sentence(report: str, folder: Path) -> None:
    (folder / "report.json").write_text(report)
    manifest = json.loads((folder / MANIFEST).read_text())
    manifest["files"]["report.json"] = hash_file(folder / "report.json")
    (folder / MANIFEST).write_text(json.dumps(manifest))
    done = run_fingertip("build", NAME, "--check", "--verify", "--out", folder)
    assert done.returncode == 2
    assert "report.json: " in done.stderr


def test_folder_is_compared_with_the_design_that_it_was_made_from(
    folder: Path, tmp_path: Path
) -> None:
    """Two designs of one name: the folder is that of the second."""
    for name, width_mm in (("new", 19.4), ("old", 19.0)):
        text = f'name = "{NAME}"\n[skin]\nwidth_mm = {width_mm}\n'
        (tmp_path / f"{name}.toml").write_text(text)
    loaded = [Design.load(tmp_path / "new.toml"), Design.load(NAME)]
    assert compare_folder(loaded, folder).faults == ()
    (fault,) = compare_folder([Design.load("fsr400"), Design.load("fsr402")], folder).faults
    assert "not of fsr400 and fsr402" in fault


@pytest.mark.full
def test_command_that_is_proposed_mends_the_folder(other: Path) -> None:
    """It has the options of the folder: some parts, one format, a
    coarse tolerance; and overwrites what was changed.
    """
    folder = other.parent / "coarse"
    build(Design.load(NAME), folder, parts=["bone", "core"], formats=["stl"], tolerance_mm=0.05)
    shutil.copy(other / "bone.stl", folder)
    words = ("build", NAME, "--check", "--parts", "bone,core", "--out", str(folder))
    proposed = run_fingertip(*words).stdout.splitlines()[-1].removeprefix("next: fingertip ")
    expected = (
        f"build {NAME} --formats stl --parts bone,core --tolerance-mm 0.05 --force --out {folder}"
    )
    assert proposed == expected
    before = sorted(path.name for path in folder.rglob("*"))
    assert run_fingertip(*proposed.split()).returncode == 0
    assert sorted(path.name for path in folder.rglob("*")) == before
    assert run_fingertip(*words).returncode == 0


def test_parts_that_are_missing_are_named(other: Path) -> None:
    folder = other.parent / "some"
    build(Design.load(NAME), folder, parts=["bone"], formats=["stl"], tolerance_mm=0.2)
    done = run_fingertip("build", NAME, "--check", "--out", folder)
    assert done.returncode == 1
    assert "was made without skin, mold_palmar, mold_dorsal, core, stand" in done.stdout
    assert (
        run_fingertip("build", NAME, "--check", "--parts", "bone", "--out", folder).returncode == 0
    )


def test_wrong_folder_is_an_error(folder: Path) -> None:
    for place, said in (
        ("board", "holds the board of 'first_finger' and no parts"),
        ("steps/nowhere", "does not exist"),
    ):
        done = run_fingertip("build", NAME, "--check", "--out", folder / place)
        assert done.returncode == 2
        assert said in done.stderr
    (folder / MANIFEST).unlink()
    done = run_fingertip("check", folder)
    assert done.returncode == 1
    assert "has a report.json and no manifest.json" in done.stdout


def test_mesh_that_cannot_be_compared_is_refused(folder: Path) -> None:
    shutil.copy(folder / "bone.stl", folder / "bone_old.stl")
    for words, said in (
        (
            (NAME, folder / "bone_old.stl"),
            "has the name of no part of first_finger; name it after its part (bone,",
        ),
        ((NAME, "fsr400", folder / "bone.stl"), "is compared with the design of one finger"),
    ):
        done = run_fingertip("check", *words, "--tolerance-mm", "0.1")
        assert done.returncode == 2
        assert said in done.stderr
    shutil.copy(folder / "bone.stl", folder / "Bone.STL")
    assert check_mesh_file(folder / "Bone.STL", Design.load(NAME)).part == "bone"


@pytest.mark.full
def test_check_of_a_design_and_a_folder_compares_them(folder: Path, other: Path) -> None:
    assert run_fingertip("check", NAME, folder, "--tolerance-mm", "0.05").returncode == 0
    done = run_fingertip("check", NAME, other, "--tolerance-mm", "0.05")
    assert done.returncode == 1
    assert "holds the parts of 'wider', not of first_finger" in done.stdout


def test_another_version_that_makes_the_same_parts_passes_and_one_that_does_not_fails(
    folder: Path,
) -> None:
    forget_program(folder)
    assert run_fingertip("build", NAME, "--check", "--verify", "--out", folder).returncode == 0

    move_mesh(folder / "bone.stl", lambda corners: corners * np.array([1.0, 1.0, 1.001]))
    manifest = json.loads((folder / MANIFEST).read_text())
    # As another version would have written it.
    manifest["files"]["bone.stl"] = hash_file(folder / "bone.stl")
    (folder / MANIFEST).write_text(json.dumps(manifest))
    done = run_fingertip("build", NAME, "--check", "--verify", "--out", folder)
    assert done.returncode == 1
    assert "bone.stl: differs from what this design gives" in done.stdout


# Loose meshes, without a manifest
# --------------------------------

LOOSE = {
    "part of another design": (
        "bone",
        lambda path, other: shutil.copy(other / "bone.stl", path),
        "it is not bone of this design",
    ),
    "inches": (
        "bone",
        lambda path, other: move_mesh(path, lambda v: v / 25.4),
        "the file is in inches",
    ),
    "scale": (
        "bone",
        lambda path, other: move_mesh(path, lambda v: v * 1.01),
        "1.01 times as large as bone",
    ),
    "half moved across": (
        "mold_palmar",
        lambda path, other: move_mesh(
            path.with_name("mold_dorsal.stl"), lambda v: v + np.array([0.4, 0, 0])
        ),
        "export both halves of one design",
    ),
    "half moved along": (
        "mold_palmar",
        lambda path, other: move_mesh(
            path.with_name("mold_dorsal.stl"), lambda v: v + np.array([0, 0, 0.05])
        ),
        "export both halves of one design",
    ),
    "half moved apart": (
        "mold_palmar",
        lambda path, other: move_mesh(
            path.with_name("mold_dorsal.stl"), lambda v: v + np.array([0, 0.4, 0])
        ),
        "export both halves of one design",
    ),
    "half of another design": (
        "mold_palmar",
        lambda path, other: shutil.copy(other / "mold_dorsal.stl", path.parent),
        "export both halves of one design",
    ),
}


@pytest.mark.every_case
@pytest.mark.parametrize("name", LOOSE)
def test_fault_of_a_loose_mesh_is_noticed(name: str, folder: Path, other: Path) -> None:
    part, cause, said = LOOSE[name]
    path = folder / f"{part}.stl"
    cause(path, other)
    file = check_mesh_file(path, Design.load(NAME))
    failed = [describe_mesh_cause(file, check) for check in file.checks if not check.passed]
    assert failed
    assert any(said in sentence for sentence in failed), failed


def test_loose_meshes_of_the_design_pass(folder: Path) -> None:
    paths = [
        folder / name
        for name in ("bone.stl", "print/bone.stl", "skin.3mf", "mold_palmar.stl", "core.stl")
    ]
    for path in paths:
        file = check_mesh_file(path, Design.load(NAME))
        assert file.part == file.path.stem
        assert [check for check in file.checks if not check.passed] == []
