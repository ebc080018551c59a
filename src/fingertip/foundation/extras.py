"""Other packages: optional ones, and plug-ins that add detectors and checks.

The core is installed without an extra. STEP files, trimesh meshes, plots, the samplers of sweeps,
compiled loops and some file formats need one more package each. Modules import such a package where
they use it, after `require`, or with `load`; both raise an error with the command that installs it.

Plug-ins are found by the entry points in their metadata, without running any of their code. They
are imported when they are asked for. An error of a plug-in names its package.
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
    """Return the command that installs optional packages for the running program."""
    names = dict.fromkeys(EXTRAS[module] for module in modules)
    return f'{find_pip()} "{DISTRIBUTION}[{",".join(names)}]"'


def find_pip() -> str:
    """Return the command that installs packages for this interpreter, typed in the current folder.

    A bare `pip` may belong to another interpreter.
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
    """Describe missing packages and the command that installs them, as the end of a sentence."""
    names = join_words(_PACKAGES.get(module, module) for module in modules)
    subject, verb = ("package", "is") if len(modules) == 1 else ("packages", "are")
    return f"the {subject} {names}, which {verb} not installed; {install_command(*modules)}"


def say_left_out(files: Mapping[str, str], progress: Callable[[str], None]) -> None:
    """Report which files are left out because of missing packages, and the command that adds them.

    `files` names them by the module that they need.
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
    """Import a module of an optional package. Raises MissingLibraryError."""
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
    """Describe a missing package that an optional one needs; None for any other error."""
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
    """Find the entry points of a group by name.

    Packages in the current folder are not installed, and are left out.
    """
    from importlib.metadata import distributions  # heavy to import  # noqa: PLC0415

    here = ""
    with contextlib.suppress(FileNotFoundError):
        here = os.getcwd()

    entries: dict[str, dict[EntryPoint, None]] = {}
    for package in distributions(path=[folder for folder in sys.path if folder not in ("", here)]):
        # A package with damaged metadata may have no entry point of this group at all.
        with contextlib.suppress(Exception):
            for entry in package.entry_points:
                if entry.group == group:
                    entries.setdefault(entry.name, {})[entry] = None

    return {name: tuple(entries[name]) for name in sorted(entries)}


def load_plugin(group: str, name: str, taken: Collection[str] = ()) -> Any:
    """Import the entry point of this name. Raises FingertipError."""
    entries = find_plugins(group)[name]
    if len(entries) > 1 or name in taken:
        owners = " and ".join(entry.value for entry in entries)
        message = (
            f"{owners} bring a name that exists already; remove the package, or let it have "
            "another name."
        )
        raise FingertipError(Issue(f"{group}, {name}", message))

    with blame_plugin(group, name):
        return entries[0].load()


def call_plugins(group: str, *arguments: Any) -> Iterator[Any]:
    """Call the function of each package with the same arguments, and yield what they yield.

    Raises FingertipError.
    """
    for name in find_plugins(group):
        function = load_plugin(group, name)
        with blame_plugin(group, name):
            results = [*function(*arguments)]

        yield from results


@contextlib.contextmanager
def blame_plugin(group: str, name: str) -> Iterator[None]:
    """Turn an unexpected exception of a plug-in into a FingertipError that names its package."""
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
