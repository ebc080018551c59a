"""Loops in plain Python and compiled: which form runs when, and that both give the same bits."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import partial

import numpy as np
import pytest

from fingertip.foundation import jit
from fingertip.foundation.jit import (
    LOAD_S,
    CompiledLoop,
    MutableFloats,
    compile_for_process,
    compiled,
    interpreted,
)


def _double(values, out: MutableFloats):
    for i in range(len(values)):
        out[i] = 2 * values[i]


def _accumulate(values, total: MutableFloats, out: MutableFloats):
    for i in range(len(values)):
        total[0] += values[i]
        out[i] = total[0]


def make_loop(function=_double, plain_us=1e3):
    return CompiledLoop(function, samples="values", plain_us=plain_us)


def test_plain_loop_receives_lists_and_fills_arrays():
    received = []

    def loop(values, factor, out: MutableFloats):
        received.append((type(values), type(out)))
        out[0] = factor * values[1]

    values = np.array([1.0, 2.0])
    out = np.zeros(2)
    make_loop(loop)(values, 3.0, out)
    assert received == [(list, list)]
    assert out.tolist() == [6.0, 0.0]
    assert values.tolist() == [1.0, 2.0]


def test_block_compiles_its_loops():
    pytest.importorskip("numba")
    loop = make_loop()
    out = np.zeros(3)
    loop(np.ones(3), out)
    assert loop._compiled is None
    for _ in range(2):
        with compiled():
            loop(np.full(3, 2.0), out)
    assert out.tolist() == [4.0, 4.0, 4.0]
    assert not jit._always_compile


def test_interpreted_block_compiles_nothing():
    pytest.importorskip("numba")
    loop = make_loop()
    out = np.zeros(3000)
    with compiled(), interpreted():
        loop(np.ones(3000), out)

    assert loop._compiled is None
    assert out.tolist() == [2.0] * 3000


def test_loop_compiles_from_its_break_even_on():
    """Only the samples asked for count, whether in one call or in many."""
    pytest.importorskip("numba")
    loop = make_loop()
    assert loop.break_even == round(LOAD_S / 1e-3)
    for _ in range(2):
        half = loop.break_even // 2
        loop(np.ones(half - 1), np.zeros(half - 1))
        assert loop._compiled is None
    loop(np.ones(2), np.zeros(2))
    assert loop._compiled is not None
    whole = make_loop()
    whole(np.ones(whole.break_even), np.zeros(whole.break_even))
    assert whole._compiled is not None


def test_state_in_lists_carries_over_from_plain_to_compiled():
    pytest.importorskip("numba")
    values = np.random.default_rng(0).normal(size=300)
    loop = make_loop(_accumulate)
    total = [0.0]
    first = np.zeros(100)
    second = np.zeros(200)
    loop(values[:100], total, first)
    with compiled():
        loop(values[100:].tolist(), total, second)
    assert isinstance(total, list)
    whole = np.zeros(300)
    make_loop(_accumulate)(values, [0.0], whole)
    assert np.concatenate((first, second)).tobytes() == whole.tobytes()
    assert total == [whole[-1]]


def test_without_numba_every_loop_runs_plain(monkeypatch):
    monkeypatch.setattr(jit, "available", lambda: False)
    loop = make_loop()
    out = np.zeros(loop.break_even)
    with compiled():
        loop(np.ones(loop.break_even), out)
    assert out[0] == 2.0
    assert loop._compiled is None
    assert compile_for_process(_double) is _double


@pytest.mark.second
def test_cache_follows_a_helper_of_another_file(tmp_path):
    pytest.importorskip("numba")
    (tmp_path / "factor.py").write_text("def scale(x):\n    return 2 * x\n")
    (tmp_path / "factor_loop.py").write_text(
        "import numpy as np\nfrom factor import scale\nfrom fingertip.foundation.jit import "
        "CompiledLoop, compiled\n"
        "def loop(values, out: 'MutableFloats'):\n    for i in range(len(values)):\n        "
        "out[i] = scale(values[i])\n"
        "out = np.zeros(1)\nwith compiled():\n"
        "    CompiledLoop(loop, scale, samples='values', plain_us=1e3)(np.ones(1), "
        "out)\nprint(out[0])\n"
    )
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path]),
        "NUMBA_CACHE_DIR": "",
    }
    run = partial(
        subprocess.check_output,
        [sys.executable, "factor_loop.py"],
        cwd=tmp_path,
        env=environment,
        text=True,
    )
    assert [run(), run()] == ["2.0\n", "2.0\n"]
    (tmp_path / "factor.py").write_text("def scale(x):\n    return 3 * x + 0 * x\n")
    assert run() == "3.0\n"
