"""`install.sh` in a fresh clone, and `uvx`, as README and docs/install.md show them."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

import fingertip
from tests.published.conftest import BROKEN, Installation, run

pytestmark = pytest.mark.full


@pytest.fixture
def clone(source: Path, tmp_path: Path) -> Iterator[Path]:
    """Fresh clone of the repository."""
    folder = tmp_path / "fingertip"
    run("git", "clone", "--quiet", source, folder, cwd=tmp_path)
    yield folder
    shutil.rmtree(folder)


@pytest.fixture(scope="module")
def uv(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with uv and uvx in it."""
    venv = tmp_path_factory.mktemp("uv") / "venv"
    run("python3", "-m", "venv", venv, cwd=venv.parent)
    run(venv / "bin" / "pip", "install", "--quiet", "uv", cwd=venv.parent)
    folder = venv.parent / "bin"
    folder.mkdir()
    for name in ("uv", "uvx"):
        (folder / name).symlink_to(venv / "bin" / name)
    return folder


@pytest.fixture(scope="module")
def path_without_uv(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Search path of this machine, in which programs that stand beside uv are found and
    uv is not.
    """
    folders = []
    for i, folder in enumerate(map(Path, os.environ["PATH"].split(os.pathsep))):
        if not (folder / "uv").exists():
            folders.append(folder)
            continue
        others = tmp_path_factory.mktemp(f"path-{i}")
        for program in folder.iterdir():
            if program.name not in ("uv", "uvx"):
                (others / program.name).symlink_to(program)
        folders.append(others)
    return os.pathsep.join(map(str, folders))


@pytest.mark.every_case
@pytest.mark.parametrize("installer", ["pip", "uv"])
def test_install_script_makes_a_finger(
    installer: str, clone: Path, uv: Path, path_without_uv: str
) -> None:
    path = path_without_uv if installer == "pip" else f"{uv}{os.pathsep}{path_without_uv}"
    run("sh", "install.sh", cwd=clone, PATH=path)
    place = Installation(clone / ".venv" / "bin", clone)
    place.accepts("make", "params/first_finger.toml")
    assert (clone / "out/first_finger/assembly.step").stat().st_size
    assert (clone / "out/first_finger/drawing.pdf").stat().st_size
    (clone / "broken.toml").write_text(BROKEN)
    place.refuses("make", "broken.toml")


def test_install_script_brings_what_the_tests_need(
    clone: Path, uv: Path, path_without_uv: str
) -> None:
    run("sh", "install.sh", "test", cwd=clone, PATH=f"{uv}{os.pathsep}{path_without_uv}")
    tests = run(
        clone / ".venv/bin/pytest",
        "-q",
        "tests/test_extras.py",
        "tests/test_what_stays.py",
        cwd=clone,
    )
    assert " passed" in tests.stdout
    assert " failed" not in tests.stdout
    # As the job of a release does.
    run("sh", "tools/pack_release", "dist", "first_finger", cwd=clone)
    packed = {path.name for path in (clone / "dist").iterdir()}
    assert packed == {"first_finger.zip", f"fingertip_kit-{fingertip.__version__}-py3-none-any.whl"}


def test_uvx_runs_the_wheel(wheel: Path, uv: Path, tmp_path: Path, path_without_uv: str) -> None:
    path = f"{uv}{os.pathsep}{path_without_uv}"
    uvx = (uv / "uvx", "--from", wheel, "fingertip")
    run(*uvx, "make", "first_finger", cwd=tmp_path, PATH=path)
    made = tmp_path / "out" / "first_finger"
    assert all(
        (made / name).stat().st_size for name in ("bone.stl", "index.html", "print/plate_fdm.3mf")
    )
    (tmp_path / "broken.toml").write_text(BROKEN)
    done = run(*uvx, "make", "broken.toml", cwd=tmp_path, check=False, PATH=path)
    assert done.returncode == 2
    assert "skin.width_mm: 3" in done.stderr
