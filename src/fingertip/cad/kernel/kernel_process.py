"""Start of a process for the B-rep kernel, and import of CadQuery without what it does not need.

CadQuery imports a viewer (vtk), two optimisers (casadi, nlopt) and a library for DXF files (ezdxf)
together with its solids. They take two thirds of the time of its import, and nothing here uses
them. A process that only makes solids gets placeholders in their place.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType
from typing import Any

from fingertip.foundation.workers import Worker, can_fork

_LEFT_OUT = ("casadi", "ezdxf", "nlopt", "vtkmodules", "OCP.IVtkOCC", "OCP.IVtkVTK")


def start_kernel(folder: Path) -> Worker:
    """Start a process for the B-rep kernel in a folder: a copy of this one, which saves the time to
    import all modules.

    Where this process has loaded the kernel, it is a new one: a copy would go on with the numbers
    of its products, which end up in STEP files, and without its threads.
    """
    return Worker(folder, is_fork=can_fork() and "OCP" not in sys.modules)


def import_without_viewer() -> None:
    """Import CadQuery with placeholders for its viewer, optimisers and DXF files.

    Only for a process of its own: the placeholders stay. A CadQuery that needs more of them than
    names, or is not installed, is left to the import of `brep`, which says what is missing.
    """
    finder = _PlaceholderFinder()
    sys.meta_path.insert(0, finder)
    try:
        import cadquery  # noqa: F401, PLC0415
    except (AttributeError, ImportError, TypeError):
        _forget_placeholders()
    finally:
        sys.meta_path.remove(finder)


def _forget_placeholders() -> None:
    for name, module in list(sys.modules.items()):
        if isinstance(module, _Placeholder) or name.partition(".")[0] == "cadquery":
            del sys.modules[name]


class _PlaceholderName(type):
    """Class that stands for a class, constant or function of a library that is left out."""

    def __getattr__(cls, name: str) -> int:
        if name.startswith("__"):
            raise AttributeError(name)

        return 0


class _Placeholder(ModuleType):
    """Module in which every name is found."""

    def __getattr__(self, name: str) -> type:
        if name.startswith("__"):
            raise AttributeError(name)

        return _PlaceholderName(name, (), {})


class _PlaceholderFinder(MetaPathFinder, Loader):
    """Finder that answers for the libraries that are left out."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        is_left_out = any(f"{fullname}.".startswith(f"{name}.") for name in _LEFT_OUT)
        return ModuleSpec(fullname, self, is_package=True) if is_left_out else None

    def create_module(self, spec: ModuleSpec) -> Any:
        return _Placeholder(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        pass
