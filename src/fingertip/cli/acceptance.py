"""`fingertip acceptance`: write the acceptance sheet of a finger."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import Console, ForceOption, JsonOption, QuietOption, SetOption, command
from fingertip.cli.options import DesignArgument
from fingertip.cli.output_files import find_file_issues


@command
def acceptance(
    design: DesignArgument,
    out: Annotated[Path | None, typer.Option(help="Markdown file to write; out/NAME/acceptance.md by default.")] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Write the acceptance sheet: tests of the sensor and of the finished finger, with limits and causes of failure."""
    from fingertip.acceptance.sheet import acceptance_data, render_acceptance
    from fingertip.build_files import parts_writer
    from fingertip.cli.load import load_design
    from fingertip.errors import OutputError
    from fingertip.files import write_file
    from fingertip.make_files import ACCEPTANCE, simulate_and_detect

    console = Console(as_json, quiet)
    if issues := list(find_file_issues("--out", out, ".md")):
        raise OutputError(issues)
    loaded, _ = load_design(design, changes, console.progress)
    path = out or Path("out") / loaded.name / ACCEPTANCE
    if out is None:
        parts_writer(loaded, path.parent, force).check_addition((ACCEPTANCE,))
    _, found = simulate_and_detect(loaded, console.progress)
    data = acceptance_data(loaded, found.detection)
    page = render_acceptance(data).encode()
    if out is None:
        parts_writer(loaded, path.parent, force).add({ACCEPTANCE: page})
    else:
        write_file(out, page)
    console.result({**data, "page": str(path)}, f"acceptance sheet written to {path}")
