"""Agreement of install.sh, constraints.txt and pyproject.toml about what is installed. No test needs the network."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

from fingertip.foundation.extras import DISTRIBUTION, EXTRAS
from tests.tools import require_tool
from tools.dependencies.pins import CONSTRAINTS, ROOT, canonical, names_of, read_pins, read_project

INSTALL = ROOT / "install.sh"
SCRIPTS = [INSTALL, *sorted(path for path in (ROOT / ".ci").iterdir() if path.is_file() and not path.suffix)]


def lines() -> list[str]:
    text = CONSTRAINTS.read_text(encoding="utf-8")
    return [line for line in text.splitlines() if line and not line.startswith("#")]


def pins() -> dict[str, str]:
    return {canonical(name): version for name, version in read_pins(CONSTRAINTS.read_text(encoding="utf-8")).items()}


def named_dependencies() -> list[str]:
    """Dependencies of the core and of all extras, without the package itself, of which some extras consist."""
    extras = read_project()["optional-dependencies"].values()
    names = names_of([*read_project()["dependencies"], *(entry for extra in extras for entry in extra)])
    return [name for name in names if name != DISTRIBUTION]


def test_messages_name_the_extra_that_installs_each_package() -> None:
    extras = read_project()["optional-dependencies"]
    for module, extra in EXTRAS.items():
        package = {"OCP": "cadquery", "dask": "distributed"}.get(module, module)  # distributed brings dask
        assert names_of(extras[extra])[0] == package
    assert set(EXTRAS.values()) == set(extras) - {"usual", "all", "docs", "test"}
    named = {name for line in (*extras["usual"], *extras["all"]) for name in re.findall(r"[\w-]+", line)}
    assert named == {DISTRIBUTION, "usual", *EXTRAS.values()}
    assert extras["test"][0] == f"{DISTRIBUTION}[all,docs]"
    assert read_project()["name"] == DISTRIBUTION


def test_constraints_are_plain_pins_of_every_dependency() -> None:
    wrong = [line for line in lines() if not re.fullmatch(r"[A-Za-z0-9][\w.-]*==[0-9][0-9A-Za-z.]*", line)]
    assert wrong == []
    names = [canonical(line.split("==")[0]) for line in lines()]
    assert names == sorted(set(names))
    assert set(named_dependencies()) <= pins().keys()
    text = CONSTRAINTS.read_text(encoding="utf-8")
    assert not re.search(r"://|(^|\s)[/~@\\]", text), "they name no place"


def test_installed_versions_are_the_pinned_ones() -> None:
    if Path(sys.prefix).resolve() != ROOT / ".venv":
        pytest.skip(f"{sys.prefix} was not made by install.sh: its versions are anybody's")
    installed = {canonical(d.metadata["Name"]): d.version for d in metadata.distributions()}
    wrong = {name: (installed[name], pin) for name, pin in pins().items() if installed.get(name, pin) != pin}
    assert wrong == {}
    unpinned = set(installed) - set(pins()) - {DISTRIBUTION, "pip", "setuptools"}
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


LIST = """\
# covers cpython-311-x86_64-linux-gnu x86_64
a==1 \\
    --hash=sha256:00 \\
    --hash=sha256:11
# end of core
b==1 ; (python_version == "3.11") \\
    --hash=sha256:00
# end of usual
c==1 \\
    --hash=sha256:00
# end of all
# end of test
"""


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A folder with install.sh and a .venv whose Python only notes what pip is asked for."""
    (tmp_path / ".venv/bin").mkdir(parents=True)
    (tmp_path / "src/fingertip").mkdir(parents=True)
    (tmp_path / "install.sh").write_bytes(INSTALL.read_bytes())
    for name in ("pyproject.toml", "src/fingertip/__init__.py"):
        (tmp_path / name).write_text(name, encoding="utf-8")
    (tmp_path / "constraints-hashes.txt").write_text(LIST, encoding="utf-8")
    set_python(tmp_path, "cpython-311-x86_64-linux-gnu x86_64")
    (tmp_path / ".venv/bin/pip").write_text(f"#!{(tmp_path / '.venv/bin/python').resolve()}\n", encoding="utf-8")
    return tmp_path


def set_python(folder: Path, target: str, pip: str = "true") -> None:
    """Write a Python that says what it was built for, notes what pip is asked to install, and then runs a command."""
    program = f'[ "$1" != -c ] || echo "{target}"\n[ "$3" != install ] || {{ echo "$@" >>asked; {pip}; }}\n'
    python = folder / ".venv/bin/python"
    python.write_text(f"#!/bin/sh\n{program}", encoding="utf-8")
    python.chmod(0o755)


def run_install(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    command = ["sh", str(folder / "install.sh"), *words]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def install(folder: Path, *words: str) -> str:
    """Run install.sh and return what pip was asked to install at last; empty if pip was not needed."""
    (folder / "asked").unlink(missing_ok=True)
    done = run_install(folder, *words)
    assert (done.returncode, done.stderr) == (0, "")
    return (folder / "asked").read_text(encoding="utf-8").split()[-1] if (folder / "asked").exists() else ""


def test_install_adds_what_the_present_installation_lacks(checkout: Path) -> None:
    asked = [install(checkout, *words) for words in (["core"], [], [], ["core"], ["all"], ["test"], ["test"], [])]
    assert asked == [".", ".[usual]", "", "", ".[all]", ".[all,test]", "", ""]
    # The dependencies change, and an earlier install.sh has left its mark.
    (checkout / "constraints-hashes.txt").write_text(LIST.replace("a==1", "a==2"), encoding="utf-8")
    assert install(checkout) == ".[usual]"
    for content, wanted in (('__version__ = "2"\n', ".[usual]"), ('__version__ = "2"\n__all__ = []\n', "")):
        (checkout / "src/fingertip/__init__.py").write_text(content, encoding="utf-8")
        assert install(checkout) == wanted
    (checkout / ".venv/installed").write_text("4022803434 5704 test", encoding="utf-8")
    assert install(checkout, "test") == ".[all,test]"
    done = run_install(checkout, "tests")
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == "install: the words it takes are 'core', 'all' and 'test'; not 'tests'\n"


@pytest.mark.parametrize(("words", "end"), [(["core"], "core"), ([], "usual"), (["test"], "test")])
def test_install_compares_every_package_of_its_level(checkout: Path, words: list[str], end: str) -> None:
    install(checkout, *words)
    first, second = (checkout / "asked").read_text(encoding="utf-8").splitlines()
    assert first == "-m pip install -q --no-compile --require-hashes --only-binary=:all: -r .venv/requirements.txt"
    assert second.startswith("-m pip install -q --no-index --no-build-isolation -e .")
    required = (checkout / ".venv/requirements.txt").read_text(encoding="utf-8")
    assert required == LIST[: LIST.index(f"{end}\n")] + f"{end}\n"


@pytest.mark.parametrize(
    "target", ["cpython-314-x86_64-linux-gnu x86_64", "cpython-311-x86_64-linux-musl x86_64", "cpython-311-x86_64"]
)
def test_install_says_that_it_compares_nothing_where_there_are_no_hashes(checkout: Path, target: str) -> None:
    set_python(checkout, target)
    said = f"install: constraints-hashes.txt does not cover this Python ({target}): packages are installed without"
    assert said in run_install(checkout).stdout
    first, _ = (checkout / "asked").read_text(encoding="utf-8").splitlines()
    assert first == "-m pip install -q --no-compile -r .venv/requirements.txt"
    required = (checkout / ".venv/requirements.txt").read_text(encoding="utf-8").splitlines()
    assert [line for line in required if line[0] != "#"] == ["a==1", 'b==1 ; (python_version == "3.11")']


def test_install_and_the_step_error_name_the_same_packages() -> None:
    installed = re.search(r'^packages="([^"]+)"$', INSTALL.read_text(encoding="utf-8"), re.MULTILINE)
    source = (ROOT / "src/fingertip/cad/kernel/brep.py").read_text(encoding="utf-8")
    named = re.search(r"apt-get install ([a-z0-9.+ -]+)", source)
    assert installed is not None
    assert named is not None
    assert named.group(1).split() == installed.group(1).split()
