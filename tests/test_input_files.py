"""The gate of all input: regular files within limits, and messages that stay one line."""

from __future__ import annotations

import errno
import os
import socket
from collections.abc import Callable
from pathlib import Path

import pytest

from fingertip.foundation.errors import InputFileError, Issue, escape_control, quote_value, shorten
from fingertip.foundation.input_files import (
    OUTPUT_LIMIT,
    PARSED_LIMIT,
    RECORDING_LIMIT,
    SAMPLES_LIMIT,
    TOML_LIMIT,
    check_regular,
    open_input,
    read_input,
)
from tests.conftest import ROOT, run_fingertip

MEGABYTE = 2**20


def make_socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as unix:
        os.chdir(path.parent)  # its path may have 107 bytes only
        unix.bind(path.name)


ODD_FILES: dict[str, tuple[Callable[[Path], object], str]] = {
    "pipe": (os.mkfifo, "is a pipe, not a regular file"),
    "device": (lambda path: path.symlink_to("/dev/zero"), "is a device, not a regular file"),
    "folder": (Path.mkdir, "is a folder, not a regular file"),
    "socket": (make_socket, "is a socket, not a regular file"),
    "missing": (lambda path: None, "cannot be read (No such file or directory)"),
    "loop": (
        lambda path: path.symlink_to(path),
        "cannot be read (Too many levels of symbolic links)",
    ),
}


@pytest.mark.parametrize("kind", ODD_FILES)
def test_what_is_no_regular_file_is_refused(
    tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    make, message = ODD_FILES[kind]
    path = tmp_path / "x.toml"
    make(path)
    for refuse in (lambda: read_input(path, TOML_LIMIT), lambda: check_regular(path)):
        with pytest.raises(InputFileError) as caught:
            refuse()
        assert message in str(caught.value)
        assert str(caught.value).endswith("; give the path of a file.")


def test_a_file_that_is_named_may_be_a_link_but_none_in_a_folder_that_is_named(
    tmp_path: Path,
) -> None:
    path = tmp_path / "a.toml"
    link = tmp_path / "link.toml"
    path.write_bytes(b"x")
    link.symlink_to(path)
    assert read_input(link, TOML_LIMIT) == b"x"
    with pytest.raises(InputFileError, match="link"):
        read_input(link, TOML_LIMIT, below=tmp_path)


def test_an_error_of_the_reader_is_no_fault_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "x.toml"
    path.write_bytes(b"two")
    with (
        pytest.raises(ValueError, match="invalid literal for int"),
        open_input(path, TOML_LIMIT) as file,
    ):
        int(file.read())
    with pytest.raises(FileNotFoundError, match="other"), open_input(path, TOML_LIMIT):
        (tmp_path / "other").read_bytes()
    with (
        pytest.raises(InputFileError, match=r"cannot be read \(Input/output error\)"),
        open_input(path, TOML_LIMIT),
    ):
        raise OSError(errno.EIO, os.strerror(errno.EIO))  # as a damaged disk raises it


def test_limits_apply_and_may_be_raised(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"#" * MEGABYTE)
    assert len(read_input(path, TOML_LIMIT)) == MEGABYTE
    path.write_bytes(b"#" * (MEGABYTE + 1))
    done = run_fingertip("params", path)
    assert (
        "has 1 MB or more; at most 1 MB are read; make it smaller, or raise FINGERTIP_MAX_TOML_MB."
        in done.stderr
    )
    monkeypatch.setenv("FINGERTIP_MAX_TOML_MB", "2")
    assert run_fingertip("params", path).returncode == 0
    for text in ("nan", "0", "-1", "1.5", "9" * 5000, "two"):
        monkeypatch.setenv("FINGERTIP_MAX_TOML_MB", text)
        done = run_fingertip("params", path)
        assert done.returncode == 2
        assert "FINGERTIP_MAX_TOML_MB: " in done.stderr
        assert "is no limit; set it to a whole number of MB above 0, or unset it." in done.stderr


def test_the_documentation_states_every_limit() -> None:
    page = (ROOT / "docs/files.md").read_text(encoding="utf-8")
    for limit in (TOML_LIMIT, RECORDING_LIMIT, SAMPLES_LIMIT, OUTPUT_LIMIT, PARSED_LIMIT):
        shown = f"{limit.default:,}".replace(",", " ") if limit.unit == 1 else f"{limit.default} MB"
        assert f"| `{limit.variable}` | {shown} |" in page


def test_values_in_messages_are_short_and_on_one_line() -> None:
    assert quote_value("x" * 100_000) == f"'{'x' * 80}'... (100000 characters)"
    assert len(quote_value(list(range(10_000)))) < 130
    assert quote_value(17.5) == "17.5"
    assert shorten("abc", 3) == "abc"
    issue = Issue("a\n\x1b[31m", "\x07" + "y" * 50_000 + " \u202e\udcff; keep the end.")
    assert str(issue).isprintable()
    assert len(str(issue)) < 5000
    assert Issue("", "word " * 800).message == "word " * 800
    assert "...(4001 characters)..." in Issue("", "word " * 800 + "x").message
    assert issue.field == "a\\n\\x1b[31m"
    assert issue.message.endswith("\\u202e\\udcff; keep the end.")
    assert Issue("", "a\nb\n  - c\n d").message == "a\\nb\n  - c\\n d", (
        "only indented lines stay lines"
    )
    assert escape_control("a\tb\n\r", spared="\n\t") == "a\tb\n\\r"
    assert Issue("", "12 µm, 3 °C ± 1").message == "12 µm, 3 °C ± 1"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a = " + "[" * 3000 + "]" * 3000, "nests tables and lists more than 12 deep"),
        ("a = " + "{a=" * 200 + "1" + "}" * 200, "nests tables and lists more than 12 deep"),
        (".".join("a" * 5000) + " = 1", "nests tables and lists more than 12 deep"),
        (
            "[skin]\nwidth_mm = " + "9" * 5000,
            "holds a number that is too long; write whole numbers of at most 18",
        ),
        (
            "[skin]\nwidth_mm = 0x" + "f" * 5000,
            "holds a number of over 300 digits, which is too large",
        ),
    ],
)
def test_odd_toml_is_refused(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "a.toml").write_text(text)
    done = run_fingertip("params", tmp_path / "a.toml")
    assert done.returncode == 2
    assert message in done.stderr
    assert len(done.stderr) < 2000


def test_odd_changes_are_refused() -> None:
    wrong = []
    for change in (
        "skin.width_mm=" + "9" * 5000,
        "skin.width_mm=" + "[" * 3000,
        "skin.width_mm=9223372036854775808",
        ".".join("a" * 3000) + "=1",
        "skin.\udcff=1",
        "skin.width_mm=\udcff",
        "skin=1",
        "=",
        "self=1",
        "skin.self=1",
        "skin.width_mm=\x1b[31m",
        "name=\x1b[31m",
        "skin.width_mm.x=1",
        "\x1b=1",
        "skin.width_mm=" + "x" * 100_000,
    ):
        done = run_fingertip("params", "--set", change)
        text = done.stderr
        is_short = (
            text.startswith("error: ")
            and text.removesuffix("\n").isprintable()
            and len(text) < 2000
        )
        if done.returncode != 2 or not is_short:
            wrong.append((change[:80], done.returncode, text))
    assert wrong == []


def test_a_path_with_nul_is_refused(tmp_path: Path) -> None:
    for text in (
        'design = "a\\u0000b"',
        'design = "a\\u0000b.toml"',
        f'design = "{"x" * 300}"',
        'design = ""',
    ):
        (tmp_path / "s.toml").write_text(f"{text}\noutputs = []\n[axes]\nskin.width_mm = [17]\n")
        done = run_fingertip("sweep", tmp_path / "s.toml", "--out", tmp_path / "out")
        assert done.returncode == 2, text
        assert done.stderr.startswith("error: ")
