"""Scenes and manipulations drawn at random within all bounds: finite signals, or a refusal whose remedy passes.

`FINGERTIP_RANDOM_SCENES` is the number of draws of each kind; `.ci/long` makes five thousand.
"""

from __future__ import annotations

import json
import os
import random

import numpy as np
import pytest

from fingertip.catalogues.bundled import list_bundled_files
from fingertip.catalogues.file_kinds import MANIPULATION, SCENE
from fingertip.foundation.jit import compiled
from fingertip.sim import ManipulationFile, SceneFile, load_simulation
from tools.fuzz.computing import LONG_S, SHORT_PHASES, draw_changes, settle
from tools.fuzz.values import list_parameters

DRAWS = int(os.environ.get("FINGERTIP_RANDOM_SCENES", "200"))
ABSENT = {"slip_pin_v", "sampled_filtered_v"}
"""Outputs that the board of the default design lacks."""


@pytest.mark.full
@pytest.mark.parametrize(("kind", "model"), [(SCENE, SceneFile), (MANIPULATION, ManipulationFile)])
def test_random_runs_are_finite(kind, model):
    parameters, names = list_parameters(model), sorted(list_bundled_files(kind))
    outputs = json.dumps([output for output in model.known_outputs() if output not in ABSENT])
    refused, touched = [], 0
    with compiled():
        for seed in range(DRAWS):
            rng = random.Random(f"{kind.name} {seed}")
            drawn = [change for _ in range(3) for change in draw_changes(rng, parameters, LONG_S)]
            name = rng.choice(names)
            run, changes = settle(
                lambda typed, name=name, seed=seed: load_simulation(name, changes=typed, seed=seed).run(),
                [*SHORT_PHASES[kind], *drawn, f"outputs={outputs}"],
                rounds=8,
            )
            if run is None:
                refused.append((name, changes))
                continue
            wrong = [column for column, values in run.columns.items() if not np.isfinite(values).all()]
            assert not wrong, (name, changes)
            force_n = run.output("force_n") if kind is MANIPULATION else run.columns["force_n"]
            assert force_n.min() >= 0.0, (name, changes)
            touched += force_n.max() > 0.1
    assert not refused
    assert touched > 0.9 * DRAWS
