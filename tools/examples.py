"""Write the CadQuery scripts in `examples/cadquery`: `python -m tools.examples`.

Each design has a folder with the files of `fingertip build DESIGN --formats cq`. The copy of the
models stands once beside these folders, where the scripts find it too.
"""

from __future__ import annotations

import shutil
from pathlib import Path

from fingertip import Design
from fingertip.cad.files.cadquery_scripts import write_models, write_scripts
from fingertip.catalogues.output_files import MODELS_FOLDER
from fingertip.models.parts import parts_by_name

FOLDER = Path(__file__).parents[1] / "examples/cadquery"
DESIGNS = ("article", "first_finger", "fsr400", "fsr402")


def list_files() -> dict[str, bytes]:
    """List the contents of all files by their paths below FOLDER."""
    files = {f"{MODELS_FOLDER}/{name}": data for name, data in write_models().items()}
    for name in DESIGNS:
        design = Design.load(name)
        scripts = write_scripts(design, tuple(parts_by_name(design)))
        files |= {f"{name}/{file}": data for file, data in scripts.items()}

    return files


def main() -> None:
    """Write all files anew."""
    if FOLDER.exists():
        shutil.rmtree(FOLDER)

    for name, data in list_files().items():
        (FOLDER / name).parent.mkdir(parents=True, exist_ok=True)
        (FOLDER / name).write_bytes(data)


if __name__ == "__main__":
    main()
