"""Agreement of install.sh, constraints.txt and pyproject.toml about what is installed.

No test needs the network.
"""

from __future__ import annotations

import re
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from fingertip.foundation.extras import DISTRIBUTION, EXTRAS
from tests.conftest import ROOT
from tests.packages import CONSTRAINTS, asked_by_level, read_list, read_pins, read_pyproject
from tests.tools import require_tool

INSTALL = ROOT / "install.sh"
SCRIPTS = [
    INSTALL,
    *sorted(path for path in (ROOT / ".ci").iterdir() if path.is_file() and not path.suffix),
]


def test_messages_name_the_extra_that_installs_each_package() -> None:
    project = read_pyproject()["project"]
    extras = project["optional-dependencies"]
    for module, extra in EXTRAS.items():
        # Distributed brings dask.
        package = {"OCP": "cadquery", "dask": "distributed"}.get(module, module)
        assert package in {canonicalize_name(Requirement(line).name) for line in extras[extra]}
    assert set(EXTRAS.values()) == set(extras) - {"usual", "all", "docs", "test"}
    named = {
        name for line in (*extras["usual"], *extras["all"]) for name in re.findall(r"[\w-]+", line)
    }
    assert named == {DISTRIBUTION, "usual", *EXTRAS.values()}
    assert extras["test"][0] == f"{DISTRIBUTION}[all,docs]"
    assert project["name"] == DISTRIBUTION


def test_constraints_are_plain_pins_of_every_dependency() -> None:
    lines = [
        line
        for line in CONSTRAINTS.read_text(encoding="utf-8").splitlines()
        if not line.startswith("#")
    ]
    pin = r"[a-z0-9][a-z0-9-]*==[0-9][0-9A-Za-z.]*( ; [a-z0-9_=!<>.'() ]+)?"
    assert [line for line in lines if not re.fullmatch(pin, line, re.IGNORECASE)] == []
    names = [one.name for one in read_list(CONSTRAINTS)]
    assert names == sorted(set(names))
    assert {canonicalize_name(one.name) for one in asked_by_level("test")} <= read_pins().keys()


def test_installed_versions_are_the_pinned_ones() -> None:
    if Path(sys.prefix).resolve() != ROOT / ".venv":
        pytest.skip(f"{sys.prefix} was not made by install.sh: its versions are anybody's")
    pins = read_pins()
    installed = {
        canonicalize_name(one.metadata["Name"]): one.version for one in metadata.distributions()
    }
    wrong = {
        name: (installed[name], pin)
        for name, pin in pins.items()
        if installed.get(name, pin) != pin
    }
    assert wrong == {}
    unpinned = set(installed) - set(pins) - {DISTRIBUTION, "pip", "setuptools"}
    assert unpinned == set(), "run sh tools/lock"


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_script_parses(script: Path) -> None:
    first = script.read_text(encoding="utf-8").splitlines()[0]
    shell = first.removeprefix("#!/bin/")
    assert shell in ("sh", "bash")
    program = require_tool(shell, f"install {shell}")
    done = subprocess.run([program, "-n", str(script)], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


# A Python that makes a .venv with itself in it, and notes what pip is asked for.
PYTHON = """\
#!/bin/sh
case "$*" in
    "--version") echo "Python 3.11.0" ;;
    "-c import ensurepip") [ ! -e lacks_ensurepip ] ;;
    "-c import sys; print"*) echo python3.11-venv ;;
    "-m venv --clear --without-pip .venv")
        rm -rf .venv/*
        mkdir -p .venv/bin
        cp "$0" .venv/bin/python
        echo "command = python3 -m venv --clear --without-pip $PWD/.venv" >.venv/pyvenv.cfg
        ;;
    "-m pip --version") [ -e .venv/pip ] ;;
    "-m ensurepip --default-pip") touch .venv/pip ;;
    "-m pip "*) shift 2; . ./installer ;;
esac
"""
UV = """\
#!/bin/sh
case "$1" in
    --version) [ -e uses_uv ] ;;
    pip) shift; . ./installer ;;
esac
"""
# What pip or uv does: notes its arguments, and puts the program into .venv unless a file says that
# it fails.
INSTALLER = """\
echo "$@" >>asked
case "$*" in
    *" -e "*)
        printf '#!/bin/sh\\n[ ! -e .venv/damaged ] && [ ! -e broken ] && echo 0.1.0\\n' >.venv/bin/fingertip
        chmod +x .venv/bin/fingertip
        ;;
esac
"""  # noqa: E501


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with install.sh, and programs in place of Python and
    uv; uv fails unless a file `uses_uv` is there.
    """
    folder = tmp_path / "checkout"
    for name, text in (
        ("bin/python3", PYTHON),
        ("bin/uv", UV),
        ("installer", INSTALLER),
        ("install.sh", INSTALL.read_text(encoding="utf-8")),
        ("pyproject.toml", "pyproject\n"),
        ("requirements/core.txt", "a==1\n"),
        ("src/fingertip/__init__.py", '__version__ = "1"\n'),
    ):
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        path.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder / 'bin'}:/usr/bin:/bin")
    monkeypatch.delenv("PYTHON", raising=False)
    return folder


def run_install(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    command = ["sh", str(folder / "install.sh"), *words]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def install(folder: Path, *words: str) -> list[str]:
    """Run install.sh and return what pip or uv was asked for, line by line."""
    (folder / "asked").unlink(missing_ok=True)
    done = run_install(folder, *words)
    assert (done.returncode, done.stderr) == (0, "")
    return (
        (folder / "asked").read_text(encoding="utf-8").splitlines()
        if (folder / "asked").exists()
        else []
    )


def test_install_adds_what_the_present_installation_lacks(checkout: Path) -> None:
    def asked(*words: str) -> str:
        return (install(checkout, *words) or [""])[-1].rsplit(" ", 1)[-1]

    found = [
        asked(*words) for words in (["core"], [], [], ["core"], ["all"], ["test"], ["test"], [])
    ]
    assert found == [".", ".[usual]", "", "", ".[all]", ".[all,test]", "", ""]
    # The dependencies change, and an earlier install.sh has left its mark.
    (checkout / "requirements/core.txt").write_text("a==2\n", encoding="utf-8")
    assert asked() == ".[usual]"
    for content, wanted in (
        ('__version__ = "2"\n', ".[usual]"),
        ('__version__ = "2"\n__all__ = []\n', ""),
    ):
        (checkout / "src/fingertip/__init__.py").write_text(content, encoding="utf-8")
        assert asked() == wanted
    (checkout / ".venv/installed").write_text("4022803434 5704 test", encoding="utf-8")
    assert asked("test") == ".[all,test]"


def test_install_refuses_other_words(checkout: Path) -> None:
    done = run_install(checkout, "tests")
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == "install: the words it takes are 'core', 'all' and 'test'; not 'tests'\n"


@pytest.mark.parametrize("uses_uv", [False, True])
@pytest.mark.parametrize(
    ("words", "level", "project"),
    [
        (["core"], "core", "."),
        ([], "usual", ".[usual]"),
        (["all"], "all", ".[all]"),
        (["test"], "test", ".[all,test]"),
    ],
)
@pytest.mark.every_case
def test_uv_and_pip_compare_every_package_of_the_level(
    checkout: Path, uses_uv: bool, words: list[str], level: str, project: str
) -> None:
    if uses_uv:
        (checkout / "uses_uv").touch()
    end = " --python .venv/bin/python" if uses_uv else ""
    assert install(checkout, *words) == [
        "install -q --no-compile --require-hashes --only-binary :all: -r "
        f"requirements/{level}.txt{end}",
        f"uninstall -q -y fingertip{end}",
        f"install -q --no-index --no-build-isolation -e {project}{end}",
    ]
    assert (checkout / ".venv/pip").exists() != uses_uv, "uv needs no pip in .venv"


def test_uv_and_pip_take_turns_in_one_folder(checkout: Path) -> None:
    (checkout / "uses_uv").touch()
    install(checkout, "core")
    (checkout / "uses_uv").unlink()
    assert install(checkout, "core") == []
    assert install(checkout)[0].endswith("-r requirements/usual.txt")
    assert (checkout / ".venv/pip").exists()
    (checkout / "uses_uv").touch()
    assert install(checkout, "all")[0].endswith("--python .venv/bin/python")
    assert "making" not in run_install(checkout, "test").stdout


def test_pip_that_cannot_be_had_is_one_sentence_before_anything_is_made(checkout: Path) -> None:
    (checkout / "lacks_ensurepip").touch()
    (checkout / "bin/id").write_text("#!/bin/sh\necho 1000\n", encoding="utf-8")
    (checkout / "bin/id").chmod(0o755)
    done = run_install(checkout)
    assert (done.returncode, done.stdout) == (1, "")
    assert re.fullmatch(
        "install: python3 cannot put pip .*apt-get install python3.11-venv.*again\\.\n", done.stderr
    )
    assert not (checkout / ".venv").exists()
    (checkout / "uses_uv").touch()
    assert len(install(checkout)) == 3, "uv needs none"


def test_install_asks_the_program_before_it_says_installed(checkout: Path) -> None:
    install(checkout)
    assert "install: fingertip 0.1.0 is installed in .venv\n" in run_install(checkout).stdout
    (checkout / ".venv/bin/fingertip").unlink()
    assert len(install(checkout)) == 3
    assert install(checkout) == []
    # Installing again does not help where pip believes that what was deleted is there.
    (checkout / ".venv/damaged").touch()
    assert len(install(checkout)) == 6
    assert not (checkout / ".venv/damaged").exists()
    assert install(checkout) == []


def test_install_fails_if_the_program_does_not_answer(checkout: Path) -> None:
    (checkout / "broken").touch()
    for _ in range(2):
        done = run_install(checkout)
        assert done.returncode == 1
        assert done.stderr.startswith("install: fingertip does not answer, see above:")
        assert not (checkout / ".venv/installed").exists()
    (checkout / "broken").unlink()
    assert len(install(checkout)) == 3


def test_install_makes_venv_anew_where_the_folder_was_moved_or_python_is_gone(
    checkout: Path,
) -> None:
    install(checkout)
    moved = checkout.rename(checkout.with_name("it's moved"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PATH", f"{moved / 'bin'}:/usr/bin:/bin")
        assert len(install(moved)) == 3
        assert install(moved) == []
        (moved / ".venv/bin/python").unlink()
        assert len(install(moved)) == 3


def test_install_leaves_alone_what_a_link_leads_to(checkout: Path, tmp_path: Path) -> None:
    install(checkout)
    (checkout / ".venv").rename(tmp_path / "other")
    (checkout / ".venv").symlink_to(tmp_path / "other")
    (checkout / ".venv/pyvenv.cfg").write_text(
        "command = python3 -m venv /other\n", encoding="utf-8"
    )
    before = sorted((tmp_path / "other").rglob("*"))
    assert len(install(checkout)) == 3
    assert not (checkout / ".venv").is_symlink()
    assert sorted((tmp_path / "other").rglob("*")) == before


def test_install_and_the_step_error_name_the_same_packages() -> None:
    installed = re.search(
        r'^packages="([^"]+)"$', INSTALL.read_text(encoding="utf-8"), re.MULTILINE
    )
    source = (ROOT / "src/fingertip/cad/kernel/brep.py").read_text(encoding="utf-8")
    named = re.search(r"apt-get install ([a-z0-9.+ -]+)", source)
    assert installed is not None
    assert named is not None
    assert named.group(1).split() == installed.group(1).split()
