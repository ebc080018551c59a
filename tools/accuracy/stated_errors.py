"""How often the errors hold that `fingertip simulate` states, on drawn designs and scenes."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.catalogues.file_kinds import DESIGN, MANIPULATION, SCENE, list_bundled_files
from fingertip.foundation.errors import FingertipError
from fingertip.lab.accuracy.measure import REFERENCE
from fingertip.lab.accuracy.step_error import (
    bound_errors,
    find_comparable_s,
    find_differences,
    run_on_grid,
)
from fingertip.sim.contact.surface_files import ARTICLE_SURFACES
from fingertip.sim.signal.grid import TARGETS, Grid
from fingertip.sim.simulation import MAX_FORCE_N, Simulation, load_simulation


@dataclass(frozen=True)
class Tried:
    """One simulation, and by signal its stated bound and its error [N, V]."""

    simulation: Simulation
    bounds: dict[str, float]
    errors: dict[str, float]


def draw_simulation(number: int) -> Simulation:
    """Draw a bundled design, its board, and a trial, a scene or a manipulation.

    Raises FingertipError if the design cannot have the board.
    """
    draw = random.Random(f"stated error {number}")
    design = draw.choice(sorted(list_bundled_files(DESIGN)))
    variant = draw.choice(["", "", "", *VARIANT_CHANGES])
    seed = draw.randrange(10**6)
    kind = draw.choice([None, None, SCENE, MANIPULATION])
    changes = VARIANT_CHANGES[variant] if variant else ()

    if kind is None:
        return load_simulation(
            design,
            changes=changes,
            surface=draw.choice(ARTICLE_SURFACES),
            speed_m_s=round(draw.uniform(0.01, 0.2), 3),
            force_n=round(draw.uniform(0.2, MAX_FORCE_N), 2),
            seed=seed,
        )

    scene = draw.choice(sorted(list_bundled_files(kind)))
    return load_simulation(scene, design, changes=changes, seed=seed)


def try_simulation(simulation: Simulation) -> Tried:
    """Compare what is stated with steps of a sixteenth."""
    board = simulation.design.board
    signals = [name for name in TARGETS if board.has_filter or name != "envelope_v"]
    scene = simulation.scene.model_copy(update={"outputs": signals})
    run = run_on_grid(simulation.design, scene, simulation.seed)
    fine = Grid(REFERENCE * round(Grid().step_s / run.step_s))
    exact = run_on_grid(simulation.design, scene, simulation.seed, fine)
    errors = find_differences(run, exact, signals, find_comparable_s((run, exact)))
    return Tried(simulation, bound_errors(simulation, signals), errors)


def try_simulations(count: int) -> Iterator[Tried]:
    """Try so many simulations that can be run."""
    number = 0
    while count:
        try:
            yield try_simulation(draw_simulation(number))
            count -= 1
        except FingertipError:
            pass

        number += 1
