"""Loops in plain Python and compiled: when which runs, and that asking costs nothing."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip import jit
from fingertip.sim import jit as sim_jit
from fingertip.sim.jit import Kernel, compiled
from tests.conftest import run_python


def _twice(values, out):
    for i in range(len(values)):
        out[i] = 2 * values[i]


def test_plain_loops_see_lists_and_arrays_come_back():
    seen = []

    def loop(values, factor, out):
        seen.append((type(values), type(out)))
        out[0] = factor * values[1]

    values, out = np.array([1.0, 2.0]), np.zeros(2)
    Kernel(loop, outputs=1)(values, 3.0, out)
    assert seen == [(list, list)]
    assert out.tolist() == [6.0, 0.0]
    assert values.tolist() == [1.0, 2.0]


def test_compiled_only_within_the_block_and_said_once():
    pytest.importorskip("numba")
    kernel, said, out = Kernel(_twice, outputs=1), [], np.zeros(3)
    kernel(np.ones(3), out)
    assert kernel._compiled is None
    for _ in range(2):
        with compiled(said.append):
            kernel(np.full(3, 2.0), out)
    assert out.tolist() == [4.0, 4.0, 4.0]
    assert len(said) == 1
    assert "compiled once, then kept" in said[0]
    assert not sim_jit._fast


def test_a_loop_that_can_be_kept_nowhere_is_compiled_all_the_same():
    pytest.importorskip("numba")
    names: dict = {}
    exec("def loop(values, out):\n    out[0] = values[0] + 1.0\n", names)  # from no file
    out = np.zeros(1)
    with compiled():
        Kernel(names["loop"], outputs=1)(np.ones(1), out)
    assert out[0] == 2.0


def test_without_numba_the_plain_loop_runs(monkeypatch):
    monkeypatch.setattr(jit, "available", lambda: False)
    kernel, out = Kernel(_twice, outputs=1), np.zeros(1)
    with compiled():
        kernel(np.ones(1), out)
    assert out[0] == 2.0
    assert kernel._compiled is None
    assert jit.once(_twice) is _twice


def test_looking_for_numba_does_not_import_it():
    code = "import sys; from fingertip import jit, sim; jit.available(); sim.compiled; print('numba' in sys.modules)"
    assert run_python("-c", code).stdout.strip() == "False"
