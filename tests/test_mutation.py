"""Mutation testing: equivalent mutants fit a line, and compiled functions record nothing."""

from __future__ import annotations

import inspect
import re
from importlib import import_module

from fingertip.foundation.jit import CompiledLoop
from tests.conftest import ROOT
from tools.mutation.mutants import list_modules, read_equivalent
from tools.mutation.reach import start  # type: ignore[attr-defined]


def test_equivalent_mutants_fit_a_line_of_their_module_and_say_why() -> None:
    wrong = []
    for entry in read_equivalent():
        paths = [ROOT / entry["module"]] if "module" in entry else [path for _, path in list_modules()]
        texts = (path.read_text(encoding="utf-8") for path in paths if path.is_file())
        lines = [line.strip() for text in texts for line in text.splitlines()]
        fits = any(re.fullmatch(entry.get("before", f".*{entry.get('part')}.*"), line) for line in lines)
        changed = "after" in entry and any(re.fullmatch(entry["after"], line) for line in lines if line)
        if not fits or changed or len(entry["reason"]) < 20:
            wrong.append(entry)
    assert wrong == [], "the line is gone, or has no reason: remove the entry or mend it"


def test_functions_that_are_compiled_stand_in_modules_that_record_nothing() -> None:
    """Numba cannot compile what the record adds to a function, be it of the loop's own module or of another one."""
    with_loops = [import_module(name) for name, path in list_modules() if "= CompiledLoop(" in path.read_text("utf-8")]
    loops = [one for module in with_loops for one in vars(module).values() if isinstance(one, CompiledLoop)]
    functions = {function for loop in loops for function in (loop.plain, *loop._helpers)}
    assert len({function.__module__ for function in functions}) > len(with_loops), "some stand elsewhere"
    for function in functions:
        source = inspect.getsource(import_module(function.__module__))
        assert any(word in source for word in start.LOOPS), f"{function.__module__}: say which loop inlines it"
