"""Detectors and checks of other packages, found by the entry points in the metadata of installed packages.

Names are found without running anything of such a package. What it brings is imported when it is asked for, and one
that cannot be imported or fails becomes a sentence that names it.
"""

from __future__ import annotations

import contextlib
import functools
import os
import sys
from collections.abc import Collection, Iterator
from importlib.metadata import EntryPoint, distributions
from typing import Any

from fingertip.foundation.errors import FingertipError, Issue


@functools.cache
def find_plugins(group: str) -> dict[str, tuple[EntryPoint, ...]]:
    """Find the entry points of a group by name; what lies in the current folder is not installed, and not asked."""
    with contextlib.suppress(FileNotFoundError):
        here = os.getcwd()
    folders = [folder for folder in sys.path if folder and folder != here]
    found: dict[str, dict[EntryPoint, None]] = {}
    for entry in (each for package in distributions(path=folders) for each in package.entry_points):
        if entry.group == group:
            found.setdefault(entry.name, {})[entry] = None
    return {name: tuple(found[name]) for name in sorted(found)}


def load_plugin(group: str, name: str, taken: Collection[str] = ()) -> Any:
    """Import what a package brings under a name. Raises FingertipError."""
    entry, *others = find_plugins(group)[name]
    if others or name in taken:
        owners = " and ".join(each.value for each in (entry, *others))
        message = f"{owners} bring a name that exists already; remove the package, or let it have another name."
        raise FingertipError(Issue(f"{group}, {name}", message))
    with blame_plugin(group, name):
        return entry.load()


def call_plugins(group: str, *arguments: Any, taken: Collection[str] = ()) -> Iterator[Any]:
    """Call the function of each package with the same arguments, and yield what they yield. Raises FingertipError."""
    for name in find_plugins(group):
        function = load_plugin(group, name, taken)
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
        source, reason = find_plugins(group)[name][0].value, f"{type(error).__name__}: {error}"
        raise FingertipError(Issue(f"{group}, {name}", f"{source} failed ({reason}); correct or remove it.")) from error
