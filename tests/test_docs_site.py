"""Site of the documentation: what is generated, and the built
site, which asks nothing of another server.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import typer.main

from fingertip.cli import app
from fingertip.design.parameters import PARAMETERS
from tests.conftest import ROOT
from tests.tools import require_module
from tools.docs_site import reference

CONFIGURATION = ROOT / "tools" / "docs_site" / "mkdocs.yml"
PAGES = {path.name for path in (ROOT / "docs").glob("*.md")}


def test_every_page_parameter_and_command_is_in_the_site() -> None:
    named = re.findall(r"^ +- (?:.*: )?(\w+\.md)$", CONFIGURATION.read_text(), re.MULTILINE)
    assert sorted(named) == sorted(PAGES)
    rows = re.findall(r"^\| `(\w+)` \| (.*) \|$", reference.list_all_parameters(), re.MULTILINE)
    assert [name for name, _ in rows] == [path.rpartition(".")[2] for path in PARAMETERS]
    assert all(len(re.split(r"(?<!\\) \| ", cells)) == 5 for _, cells in rows), (
        "no bar splits a cell"
    )
    page = reference.list_all_commands()
    commands = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    assert set(commands) <= set(re.findall(r"^## (.*)$", page, re.MULTILINE))
    assert "## calibrate sensor\n" in page
    assert "Usage: fingertip calibrate sensor READINGS" in page


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    for module in ("mkdocs", "material", "nbclient", "ipykernel"):
        require_module(module)
    folder = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "mkdocs",
            "build",
            "--strict",
            "--quiet",
            "-f",
            CONFIGURATION,
            "-d",
            folder,
        ],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"NO_MKDOCS_2_WARNING": "1"},
    )
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.full
def test_the_site_holds_what_is_generated_and_asks_nothing_of_another_server(site: Path) -> None:
    pages = list(site.glob("*.html"))
    assert len(pages) == len(PAGES) + 1  # and that of errors
    for page in pages:
        text = page.read_text(encoding="utf-8")
        assert not re.findall(
            r"<(?:script|img|iframe|source|video|audio|embed)\b[^>]*\bsrc=\"?(?:https?:)?//", text
        )
        assert not re.findall(r"<link\b(?![^>]*rel=\"?canonical)[^>]*href=\"?(?:https?:)?//", text)
        assert 'http-equiv="Content-Security-Policy" content="default-src \'self\' file:' in text
        assert not re.search(r"<!-- \w+ -->", text), "a marker that nothing replaced"
        assert 'class="mermaid"' not in text, "the theme would load a library for it"
    for sheet in site.rglob("*.css"):
        text = sheet.read_text(encoding="utf-8")
        assert not re.search(r"@import|url\(['\"]?(?:https?:)?//", text)
    assert "Usage: fingertip sweep" in (site / "reference.html").read_text()
    assert "distance_from_tip_mm" in (site / "reference.html").read_text()
    tutorial = (site / "tutorial.html").read_text()
    pictures = re.findall(r'src="(steps/[^"]+)"', tutorial)
    assert len(pictures) > 15
    assert all((site / name).stat().st_size > 1000 for name in pictures)
    ran = (site / "python.html").read_text()
    assert ran.count("data:image/png;base64,") == 2
    assert "Detection(fast: 1 interval ON, 1 of 1 slips found" in ran
    assert "at least 16.9 mm, or call fit_design(design, changes)" in ran
