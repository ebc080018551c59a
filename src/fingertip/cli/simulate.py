"""`fingertip simulate`: a sliding-finger trial of the article, any scene, or a manipulation, as the voltages that
converters would have sampled."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fingertip.cli.console import Console, JsonOption, QuietOption, SetOption, command, picture_issues

if TYPE_CHECKING:
    from fingertip.design import Design
    from fingertip.errors import Issue
    from fingertip.sim import Manipulated, ManipulationFile, SceneFile


@command
def simulate(
    file: Annotated[
        Path | None, typer.Argument(help="Design, scene or manipulation file; without it, the defaults.")
    ] = None,
    design: Annotated[
        Path | None, typer.Option("--design", "-d", help="Design file, beside a scene or manipulation file.")
    ] = None,
    out: Annotated[Path, typer.Option("--out", "-o", help="Trace to write: .csv, or .npz.")] = Path("trace.csv"),
    plot: Annotated[Path | None, typer.Option("--plot", help="Picture of the outputs to write (PNG).")] = None,
    seed: Annotated[int, typer.Option(help="Seed of force, surface and noise.")] = 0,
    speed_m_s: Annotated[
        float | None,
        typer.Option("--speed-m-s", help="Peak sliding velocity (article: 0.04, 0.06, 0.08), or the knock's (0.08)."),
    ] = None,
    surface: Annotated[str | None, typer.Option(help="smooth, medium, gross, wood, paper or plastic.")] = None,
    force_n: Annotated[
        float | None,
        typer.Option(
            "--force-n", help="Holding force, or the thumb's; by the seed if left out, 0.2 to 2 N in a trial."
        ),
    ] = None,
    grip: Annotated[
        str | None,
        typer.Option("--grip", help="Close a hand's loop: it grips harder when this detector finds slip (fast, ...)."),
    ] = None,
    changes: SetOption = None,
    parameters: Annotated[
        bool, typer.Option("--parameters", help="Print the scene's parameters, with unit, bounds and meaning.")
    ] = False,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Simulate one trial of a design, or a scene with --design, and write its trace."""
    from fingertip import sim
    from fingertip.board.values.board_values import board_values
    from fingertip.board.values.limits import converter_remarks
    from fingertip.cli.load import load_design, refuse_sweep
    from fingertip.design import Design
    from fingertip.errors import FingertipError, Issue
    from fingertip.files import write_file
    from fingertip.sim import summary
    from fingertip.sim.kinds import kind_of, split
    from fingertip.sim.scenes import scene_table
    from fingertip.sim.trace_export import file_bytes

    console = Console(as_json, quiet)
    issues: list[Issue] = []
    refuse_sweep(file)
    kind = kind_of(file) if file else Design
    for_scene, for_design = split(changes or (), kind)
    is_scene = kind is not Design
    if design and not is_scene:
        issues.append(Issue("--design", f"stands beside {file or 'no file'}, which is no scene; leave --design out."))
    if for_scene and not is_scene:
        issues.append(
            Issue(f"--set {for_scene[0]}", "changes a scene; give a scene file, such as params/scenes/*.toml.")
        )
    if out.suffix.lower() not in (".csv", ".npz"):
        issues.append(Issue("--out", f"{out.name!r} is no kind of trace file known here; end it in .csv or .npz."))
    issues.extend(picture_issues("--plot", plot))
    if grip is not None:
        issues.extend(_grip_issues(grip, kind is sim.ManipulationFile))
    if plot == out:
        issues.append(Issue("--plot", f"{plot} is the trace's own name; choose another, such as trace.png."))
    if is_scene and seed < 0:  # a trial says so itself
        issues.append(Issue("--seed", f"{seed} is negative; choose a whole number of at least 0."))
    loaded: Design | None = None
    scene: SceneFile | ManipulationFile | None = None
    design_file = design if is_scene else file
    try:
        loaded, _ = load_design(design_file, for_design)
    except FingertipError as error:
        issues.extend(error.issues)
    try:
        if kind is sim.ManipulationFile and file:
            told = _of_manipulation(surface, speed_m_s, force_n)
            scene = sim.ManipulationFile.load(file, changes=[*for_scene, *told])
        elif is_scene and file:
            scene = sim.SceneFile.load(file, changes=[*for_scene, *_of_scene(surface, speed_m_s, force_n)])
        else:
            default = sim.Trial()
            scene = sim.Trial(
                default.surface if surface is None else surface,
                default.speed_m_s if speed_m_s is None else speed_m_s,
                force_n,
                seed,
            ).scene
    except FingertipError as error:
        issues.extend(error.issues)
    if speed_m_s is not None and isinstance(scene, sim.SceneFile) and not scene.slide.distance_m:
        remedy = "leave it out, or let the finger slide with --set slide.distance_m=0.04"
        issues.append(Issue("--speed-m-s", f"{speed_m_s:g} m/s changes nothing, for nothing slides here; {remedy}."))
    if issues or loaded is None or scene is None:
        raise FingertipError(issues)

    if parameters:
        console.result({"parameters": list(scene_table.parameters(scene))}, "\n".join(scene_table.as_text(scene)))
        return

    if "voltage_v" in scene.outputs:
        for remark in converter_remarks(board_values(loaded).limits):
            console.progress(f"warning: {remark}")
    found: sim.Simulated | sim.Manipulated
    grips: dict[str, list[float]] = {}
    if isinstance(scene, sim.ManipulationFile) and grip is not None:
        found, grips["grips_s"] = _gripped(loaded, scene, grip, seed, console)
    elif isinstance(scene, sim.ManipulationFile):
        found = sim.run_manipulation(loaded, scene, None, seed, console.progress)
    else:
        found = sim.run_scene(loaded, scene, seed, console.progress)
    words = summary.as_text(found)
    if grips:
        times = ", ".join(f"{at:.2f} s" for at in grips["grips_s"])
        words.append(f"gripped harder at {times}" if times else "never gripped harder")
    contents = file_bytes(found.time_s, found.columns, out)
    if plot is not None:
        from fingertip.sim.plot import draw

        console.progress(f"drawing {plot}")
        write_file(plot, draw(found, words[0]), "--plot")
    write_file(out, contents)
    console.progress(f"wrote {out}")
    written = {"trace": out.as_posix()} | ({"plot": plot.as_posix()} if plot else {})
    console.result(written | summary.as_data(found) | grips, "\n".join(words))


def _grip_issues(grip: str, is_manipulation: bool) -> Iterable[Issue]:
    from fingertip.errors import FingertipError, Issue
    from fingertip.slip.detectors.registry import find_detector_type

    if not is_manipulation:
        yield Issue("--grip", "closes the loop of a hand; give a manipulation, such as real_manipulation.toml.")
    try:
        find_detector_type(grip)
    except FingertipError as error:
        yield from (Issue("--grip", issue.message) for issue in error.issues)


def _gripped(
    design: Design, scene: ManipulationFile, detector: str, seed: int, console: Console
) -> tuple[Manipulated, list[float]]:
    """The manipulation with a detector in the loop, and when the hand was told to grip harder [s]."""
    from fingertip.campaign.closed_loop.grip import Grip, GripSettings
    from fingertip.sim import run_manipulation
    from fingertip.slip.detectors.registry import DETECTORS

    reads = DETECTORS[detector].reads
    if reads not in scene.outputs:
        scene = scene.model_copy(update={"outputs": [*scene.outputs, reads]})
    grip = Grip(design, GripSettings(detector), len(scene.fingers))
    found = run_manipulation(design, scene, grip, seed, console.progress)
    return found, [look.time_s for look in grip.looks if look.gripped]


def _of_scene(surface: str | None, speed_m_s: float | None, force_n: float | None) -> Iterable[str]:
    """The trial's options as changes of a scene."""
    if surface is not None:
        yield f'contact.surface="{surface}"'
    if speed_m_s is not None:
        yield f"slide.speed_m_s={speed_m_s!r}"
    if force_n is not None:
        yield f"hold.min_force_n={force_n!r}"
        yield f"hold.max_force_n={force_n!r}"


def _of_manipulation(surface: str | None, speed_m_s: float | None, force_n: float | None) -> Iterable[str]:
    """And of a manipulation."""
    if surface is not None:
        yield f'object.surface="{surface}"'
    if speed_m_s is not None:
        yield f"knock.speed_m_s={speed_m_s!r}"
    if force_n is not None:
        yield f"grasp.force_n={force_n!r}"
