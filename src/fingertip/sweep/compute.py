"""What each stage computes of one design. Heavy packages are imported by the stage that needs them, when asked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, TypeAlias

from fingertip.design.model import Design
from fingertip.errors import Issue
from fingertip.sweep.sweep_file import SweepFile

if TYPE_CHECKING:
    from fingertip.cad.kernel.mesh import Mesh
    from fingertip.sim.scenes.scene_file import SceneFile
    from fingertip.slip.traces.trace import Trace
    from fingertip.sweep.cached_solids import CachedEvaluator

Recorded: TypeAlias = "tuple[Trace, float]"
"""A trial as it would be recorded, and the force that held [N]."""
Figures = dict[str, Any]
"""Output -> number; under `ISSUE` what is wrong with a point that is computed all the same."""
ISSUE = "issue"
_CLEAR_MM = 0.02
"""Off the plane where the skin ends, as the check of the thinnest place is."""


@dataclass(frozen=True)
class Asked:
    """One point, and what its stages share with other points."""

    design: Design
    scene: SceneFile | None
    file: SweepFile
    evaluator: Callable[[], CachedEvaluator]
    """Made when the first stage asks for it: a sweep of boards loads no mesh kernel."""
    traces: Callable[[int, Callable[[], Recorded]], Recorded] = lambda seed, record: record()
    """The trial of a seed, remembered where points differ in the detector's decision only."""


def lengths(asked: Asked) -> Figures:
    """Lengths that follow from the parameters."""
    from fingertip.design.geometry.mold_layout import lay_out

    design = asked.design
    m = lay_out(design, design.dimensions)
    return {
        "sensor_rim_mm": design.dimensions.sensor_rim_margin(design.bone.rim_mm, design.sensor.clearance_mm),
        "mold_width_mm": 2 * m.half_width,
        "mold_height_mm": m.palmar_height + m.dorsal_height,
        "mold_length_mm": m.distal_z - m.proximal_z,
    }


def board(asked: Asked) -> Figures:
    """Preferred values of the board, and what they achieve."""
    from fingertip.board.values.board_values import filter_values

    board = asked.design.board
    _, fitted, achieved = filter_values(board)
    resistors = ("r1_ohm", "r2_ohm", "r3_ohm", "r4_ohm", "r5_ohm", "r_lp_ohm")
    return {f"board.{name}": getattr(fitted, name) for name in resistors} | {
        "board.c_uf": 1e6 * fitted.c_f,
        "board.c_lp_uf": 1e6 * fitted.c_lp_f,
        "gain": achieved.passband_gain,
        "gain_db": achieved.passband_gain_db,
        "first_pole_hz": achieved.first_pole_hz,
        "section_hz": achieved.section_hz,
        "q": achieved.section_quality,
        "cutoff_3db_hz": achieved.cutoff_hz,
        "cutoff_error_percent": 100.0 * (achieved.cutoff_hz / board.cutoff_hz - 1.0),
        "envelope_pole_hz": achieved.envelope_pole_hz,
        "envelope_decay_ms": 1e3 * achieved.envelope_decay_s,
        "amplifier_bandwidth_hz": achieved.amplifier_bandwidth_hz,
    }


def noise(asked: Asked) -> Figures:
    """What the article's chain shows when nothing happens."""
    from fingertip.slip.detectors.noise import noise_level

    level = noise_level(asked.design)
    return {"noise_level_v": level.mean_v, "min_threshold_v": level.threshold_v}


def trials(asked: Asked) -> Figures:
    """Delay and alarms of a detector on simulated trials of the scene, each with its own seed."""
    from fingertip.campaign.judge import judge
    from fingertip.campaign.plan import Case
    from fingertip.campaign.record import reads_board, record
    from fingertip.campaign.study import Total
    from fingertip.jit import compiled

    assert asked.scene is not None
    detector, design = asked.file.detector, asked.design
    verdicts = []
    with compiled():
        for seed in range(asked.file.first_seed, asked.file.first_seed + asked.file.trials):
            case = Case("slip", asked.scene, seed)
            trace, force_n = asked.traces(seed, partial(record, design, case, reads_board(detector)))
            verdicts += judge(case, trace, force_n, detector, design, [1.0])
    total = Total(1.0, tuple(verdicts))
    minutes = sum(verdict.duration_s for verdict in verdicts) / 60.0
    return {
        "delay_ms": 1e3 * total.delay_s(0.5),
        "delay_p90_ms": 1e3 * total.delay_s(0.9),
        "found_share": total.found_share,
        "false_alarms_per_min": sum(total.alarms().values()) / minutes,
        "slips": total.slips,
    }


def skin(asked: Asked) -> Figures:
    """The skin's mesh, and nothing else's."""
    mesh = _mesh(asked, "skin")
    return {"skin_volume_mm3": mesh.volume(), "skin_area_mm2": mesh.area()}


def bone(asked: Asked) -> Figures:
    """The bone's mesh, and nothing else's."""
    volume = _mesh(asked, "bone").volume()
    return {"bone_volume_mm3": volume, "bone_mass_g": volume / 1e3 * asked.file.print_density_g_cm3}


def halves(asked: Asked) -> Figures:
    """Both halves of the mold."""
    palmar, dorsal = (_mesh(asked, f"mold_{half}").volume() for half in ("palmar", "dorsal"))
    mass = (palmar + dorsal) / 1e3 * asked.file.print_density_g_cm3
    return {"mold_palmar_volume_mm3": palmar, "mold_dorsal_volume_mm3": dorsal, "mold_mass_g": mass}


def casting(asked: Asked) -> Figures:
    """Silicone to weigh for the mold."""
    from fingertip.casting.batches import batch
    from fingertip.casting.materials import silicone
    from fingertip.casting.quantities import measure

    volumes = measure(asked.design, asked.evaluator())
    mixed = batch(silicone(asked.file.silicone), volumes.total_cm3)
    return {"silicone_in_mold_g": mixed.in_mold_g, "silicone_g": mixed.total_g}


def thickness(asked: Asked) -> Figures:
    """The thinnest place of the skin, above the plane where it is cut square, searched for up to its thickest."""
    from fingertip.cad.shapes.core import skin_interior
    from fingertip.cad.solids import Box, SuperconicSolid, difference

    evaluator, outer, skin = asked.evaluator(), SuperconicSolid(asked.design.dimensions.outer), asked.design.skin
    low_x, low_y, low_z, high_x, high_y, high_z = evaluator.manifold(outer).bounding_box()
    past = high_x - low_x
    room = Box((low_x - past, low_y - past, low_z - past), (high_x + past, high_y + past, high_z + past))
    inside = evaluator.manifold(skin_interior(asked.design)).trim_by_plane((0.0, 0.0, 1.0), _CLEAR_MM)
    outside = evaluator.manifold(difference(room, outer)).trim_by_plane((0.0, 0.0, 1.0), _CLEAR_MM)
    thickest = max(getattr(skin, f"thickness_{side}_mm") for side in ("side", "palmar", "dorsal", "tip"))
    return {"thinnest_skin_mm": float(inside.min_gap(outside, thickest))}


def checks(asked: Asked) -> Figures:
    """Every check of `fingertip check`, at the sweep's tolerance."""
    from fingertip.cad.shapes.parts import parts_by_name
    from fingertip.cad.verification.verify import verify

    found = verify(asked.design, parts_by_name(asked.design), ("stl",), asked.evaluator()).checks
    failed = [check for check in found if not check.passed]
    figures: Figures = {"checks_failed": len(failed), "checks_made": len(found)}
    if failed:
        first, *others = failed
        more = f" (and {len(others)} more: {', '.join(check.name for check in others)})" if others else ""
        unit = f" {first.unit}" if first.unit else ""
        sentence = f"is {first.value:.6g}{unit}, but {first.relation} {first.limit:.6g}{unit} is sound{more}."
        figures[ISSUE] = Issue(first.name, sentence)
    return figures


def _mesh(asked: Asked, part: str) -> Mesh:
    from fingertip.cad.shapes.parts import PARTS

    return asked.evaluator().mesh(PARTS[part].solid(asked.design))


COMPUTE: dict[str, Callable[[Asked], dict[str, Any]]] = {
    function.__name__: function
    for function in (lengths, board, noise, trials, skin, bone, halves, casting, thickness, checks)
}
"""By the name of the stage in `outputs.STAGES`."""
