"""Approved texts: stored as they stand, compared exactly or with a tolerance for numbers."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.approved import check_figures, check_text

LINES = ["peak 2.50 V at 'R1 2.5k'", "steps 40"]


def test_an_approved_text_is_stored_as_it_stands(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    path = tmp_path / "approved/text.md"

    monkeypatch.setenv("FINGERTIP_APPROVE", "1")
    check_text(path, "old\n")
    check_text(path, "# Title\n\n10 µm")
    monkeypatch.delenv("FINGERTIP_APPROVE")

    assert path.read_text(encoding="utf-8") == "# Title\n\n10 µm"
    check_text(path, "# Title\n\n10 µm".encode())
    with pytest.raises(AssertionError):
        check_text(path, "# Title\n\n10 µm\n")


def test_a_text_that_nobody_approved_is_refused(tmp_path: Path) -> None:
    with pytest.raises(AssertionError):
        check_text(tmp_path / "text.md", "text")
    with pytest.raises(AssertionError):
        check_figures(tmp_path / "figures.txt", LINES)


@pytest.mark.parametrize(
    ("lines", "is_approved"),
    [
        (LINES, True),
        (["peak 2.504 V at 'R1 2.5k'", "steps 40"], True),
        (["peak 2.52 V at 'R1 2.5k'", "steps 40"], False),
        (["top 2.50 V at 'R1 2.5k'", "steps 40"], False),
        (["peak 2.50 V at 'R1 2.501k'", "steps 40"], False),
        (["peak 2.50 V at 'R1 2.5k'"], False),
        ([*LINES, ""], False),
    ],
)
def test_figures_have_a_tolerance_and_words_have_none(
    lines: list[str],
    is_approved: bool,
    tmp_path: Path,
) -> None:
    path = tmp_path / "figures.txt"
    path.write_text("\n".join(LINES) + "\n", encoding="utf-8")

    if is_approved:
        check_figures(path, lines, rel=2e-3, abs_=1e-6)
    else:
        with pytest.raises(AssertionError):
            check_figures(path, lines, rel=2e-3, abs_=1e-6)
