"""Other packages: optional ones that an extra of the installation brings, and those that bring
detectors and checks.

The core is installed without an extra. STEP files, trimesh meshes, plots, the samplers of sweeps,
compiled loops and some file formats need one more package each. Modules import such a package where
they use it, after `require`, or with `load`; both raise an error with the command that installs it.

What other packages bring is found by the entry points in their metadata, without running anything
of them. It is imported when it is asked for; one that cannot be imported or fails becomes a
sentence that names it.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import importlib.util
import os
import shlex
import shutil
import sys
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingertip.foundation.errors import FingertipError, Issue, MissingLibraryError, join_words

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

DISTRIBUTION = "fingertip-kit"
"""Name to pip: on the package index `fingertip` is somebody else's."""
EXTRAS = {
    "OCP": "cadquery",
    "cadquery": "cadquery",
    "trimesh": "mesh",
    "lxml": "mesh",
    "networkx": "mesh",
    "matplotlib": "plots",
    "scipy": "sweep",
    "reportlab": "drawing",
    "numba": "fast",
    "pyarrow": "parquet",
    "nptdms": "tdms",
    "rosbags": "ros",
    "distributed": "cluster",
    "dask": "cluster",
    "pandas": "frames",
}
"""Module of an optional package -> extra that installs it."""
_PACKAGES = {"OCP": "cadquery", "nptdms": "npTDMS"}
"""Module -> name of its package, where they differ."""


def is_installed(module: str) -> bool:
    """Return whether an optional package is installed, without importing it."""
    try:
        return importlib.util.find_spec(module) is not None
    except ImportError:
        return False
    except ValueError:  # a module that was made in memory has no specification
        return True


def install_command(*modules: str) -> str:
    """Return the command that installs optional packages beside the
    running program, typed in the working folder.
    """
    names = dict.fromkeys(EXTRAS[module] for module in modules)
    return f'{find_pip()} "{DISTRIBUTION}[{",".join(names)}]"'


def find_pip() -> str:
    """Return how this interpreter's packages are installed: a bare `pip` may belong to
    another one.
    """
    folder = Path(sys.executable).parent
    python = sys.executable
    pip = shutil.which("pip")
    with contextlib.suppress(OSError, ValueError):  # the working folder is gone, or is not above
        python = str(Path(python).relative_to(Path.cwd()))

    if not is_installed("pip"):  # where install.sh used uv, and in environments that uv made
        if shutil.which("uv"):
            return f"uv pip install --python {shlex.quote(python)}"

        return f"{shlex.quote(python)} -m ensurepip && {shlex.quote(python)} -m pip install"

    if pip and Path(pip).parent == folder:
        with contextlib.suppress(OSError), open(pip, encoding="utf-8", errors="replace") as script:
            if os.path.samefile(script.readline().removeprefix("#!").strip(), sys.executable):
                return "pip install"

    return f"{shlex.quote(python)} -m pip install"


def describe_missing(*modules: str) -> str:
    """Describe missing packages, and the command that installs
    them, for a sentence that ends with both.
    """
    listed = join_words(_PACKAGES.get(module, module) for module in modules)
    words, verb = ("package", "is") if len(modules) == 1 else ("packages", "are")
    return f"the {words} {listed}, which {verb} not installed; {install_command(*modules)}"


def say_left_out(files: Mapping[str, str], progress: Callable[[str], None]) -> None:
    """Say what is left out for want of optional packages, given
    by module, and the command that adds it.
    """
    missing = {module: name for module, name in files.items() if not is_installed(module)}
    if missing:
        progress(
            f"left out: {join_words(dict.fromkeys(missing.values()))}; "
            f"{install_command(*missing)} adds them"
        )


def require(field: str, *modules: str, subject: str = "", alternative: str = "") -> None:
    """Check, before the work that needs them, that optional packages are installed.

    Raises MissingLibraryError.
    """
    missing = [module for module in modules if not is_installed(module)]
    if missing:
        raise MissingLibraryError(
            _make_issue(field, describe_missing(*missing), subject, alternative)
        )


def load(module: str, field: str, *, alternative: str = "") -> Any:
    package = module.partition(".")[0]
    require(field, package, alternative=alternative)
    try:
        return importlib.import_module(module)
    except ImportError as error:
        problem = (
            f"the package {_PACKAGES.get(package, package)}, which cannot be imported ({error})"
        )
        remedy = f"{problem}; {install_command(package)}"
        raise MissingLibraryError(_make_issue(field, remedy, "", alternative)) from error


def describe_import_error(error: BaseException) -> MissingLibraryError | None:
    """Describe that a package is missing which one of an extra's
    packages needs; None for any other error.
    """
    if not isinstance(error, ModuleNotFoundError) or not error.name:
        return None

    module = error.name.partition(".")[0]
    if is_installed(module):
        return None
    if module in EXTRAS:
        return MissingLibraryError(_make_issue("", describe_missing(module), "this", ""))

    sentence = (
        f"this needs the package {module}, which is not installed; {find_pip()} "
        f"{shlex.quote(module)}."
    )
    return MissingLibraryError(Issue("", sentence))


def _make_issue(field: str, needs: str, subject: str, alternative: str) -> Issue:
    sentence = f"{subject} needs {needs}".lstrip()
    return Issue(field, f"{sentence}, or {alternative}." if alternative else f"{sentence}.")


@functools.cache
def find_plugins(group: str) -> dict[str, tuple[EntryPoint, ...]]:
    """Find the entry points of a group by name; what lies in the
    current folder is not installed, and not asked.
    """
    from importlib.metadata import distributions  # heavy to import  # noqa: PLC0415

    here = ""
    with contextlib.suppress(FileNotFoundError):
        here = os.getcwd()

    found: dict[str, dict[EntryPoint, None]] = {}
    for package in distributions(path=[folder for folder in sys.path if folder not in ("", here)]):
        with contextlib.suppress(
            Exception
        ):  # damaged metadata, of a package that may bring nothing
            for entry in (each for each in package.entry_points if each.group == group):
                found.setdefault(entry.name, {})[entry] = None

    return {name: tuple(found[name]) for name in sorted(found)}


def load_plugin(group: str, name: str, taken: Collection[str] = ()) -> Any:
    """Import what a package brings under a name. Raises FingertipError."""
    entry, *others = find_plugins(group)[name]
    if others or name in taken:
        owners = " and ".join(each.value for each in (entry, *others))
        message = (
            f"{owners} bring a name that exists already; remove the package, or let it have "
            "another name."
        )
        raise FingertipError(Issue(f"{group}, {name}", message))

    with blame_plugin(group, name):
        return entry.load()


def call_plugins(group: str, *arguments: Any) -> Iterator[Any]:
    """Call the function of each package with the same arguments, and yield what they yield.

    Raises FingertipError.
    """
    for name in find_plugins(group):
        function = load_plugin(group, name)
        with blame_plugin(group, name):
            found = [*function(*arguments)]

        yield from found


@contextlib.contextmanager
def blame_plugin(group: str, name: str) -> Iterator[None]:
    """Say of an unexpected exception from which package it comes. Raises FingertipError."""
    try:
        yield
    except FingertipError:
        raise
    except Exception as error:
        source = find_plugins(group)[name][0].value
        reason = f"{type(error).__name__}: {error}"
        raise FingertipError(
            Issue(f"{group}, {name}", f"{source} failed ({reason}); correct or remove it.")
        ) from error
