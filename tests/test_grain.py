"""Report on the grain of the code: what it counts, and what it stands beside."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.tools import require_tool
from tools.grain import GrainError
from tools.grain.__main__ import main, write_report
from tools.grain.counts import Counts, add_up, count_module
from tools.grain.junit import read_seconds
from tools.grain.snapshots import find_last_release, read_checkout, read_commit
from tools.grain.tables import write_table

SOURCE = '''"""Docstring of a module,
of two lines."""

import math
from os import (
    path,
)

# a comment
TABLE = (1, 2)  # fmt: skip
"""Docstring of a constant."""


@decorator
def first(a, b):
    """Docstring of a function."""
    x, y = a, b
    return x if a else y


def second(a):
    u, v, w = a, math.pi, path

    if (n := len(u)) > 1:
        return join(u, v, w, n, 5, 6)
    return 1 if a else 2 if v else 3
'''
COUNTS = Counts(
    modules=1,
    code_lines=10,
    tokens=7 + 2 + 8 + 7 + 6 + 6 + 13 + 12 + 15 + 10,  # line by line
    packed_assignments=2,
    packed_of_three=1,
    walruses=1,
    format_skips=1,
    positional_calls=1,
    nested_conditionals=1,
    functions=2,
    function_lines=4 + 6,
)


def test_a_module_is_counted() -> None:
    assert count_module(SOURCE) == COUNTS


def test_counts_of_modules_add_up() -> None:
    assert add_up([]) == Counts()
    both = add_up([COUNTS, count_module("x = 1\n")])
    assert (both.modules, both.code_lines, both.tokens) == (2, 11, COUNTS.tokens + 3)


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("source", "names"),
    [
        ("a, b = x, y", 2),
        ("a, b = x, 0", 2),
        ("a, b, c = x, y(), z[0]", 3),
        ("a.b, c = x, y", 2),
        ("a, b = 0, 1", 0),
        ("a, b = b, a", 0),
        ("a, b = b, a + b", 0),
        ("a, b = split(x)", 0),
        ("a, *b = x, y, z", 0),
        ("a = x, y", 0),
        ("a: tuple = x, y", 0),
    ],
)
def test_a_packed_assignment_gives_several_values_to_as_many_names(source: str, names: int) -> None:
    counts = count_module(source)
    assert counts.packed_assignments == int(names > 0)
    assert counts.packed_of_three == int(names >= 3)


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("source", "lines", "tokens"),
    [
        ("x = 1\n", 1, 3),
        ("x = (  # why\n    1,\n\n    # alone\n)\n", 3, 6),
        ("x = '''a\n\nb'''\n", 2, 3),
        ("import a; x = 1\n", 0, 0),
        ("class A:\n    '''Docstring.'''\n\n    x: int\n    '''Docstring.'''\n", 2, 6),
        ("", 0, 0),
    ],
)
def test_lines_and_tokens_of_code(source: str, lines: int, tokens: int) -> None:
    counts = count_module(source)
    assert counts.code_lines == lines
    assert counts.tokens == tokens


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A checkout with a release whose only module has one line of code, and two lines now."""
    require_tool("git", "apt-get install git")
    root = tmp_path / "checkout"
    root.mkdir()
    git(root, "init", "--quiet", "--initial-branch=main")

    write(root, "src/fingertip/a.py", "x = 1\n")
    write(root, "src/other/b.py", "x = 1\n")
    write(root, "README.md", "four words\nare here")
    write(root, "docs/a.md", "two words")
    write(root, "docs/assets/b.txt", "not counted")
    write(root, ".gitignore", "out\nnode_modules\n")
    commit(root, "2026-01-01T12:00:00")
    git(root, "tag", "v0.1.0")
    git(root, "tag", "v0.9.0")
    commit(root, "2026-01-02T12:00:00")
    git(root, "tag", "v0.10.0")
    git(root, "tag", "other")

    write(root, "src/fingertip/a.py", "x = 1\ny, z = x, f(x)\n")
    write(root, "tools/new.py", "x = 1\n")
    write(root, "tools/node_modules/c.py", "x = 1\n")
    write(root, "docs/more/c.md", "three words more")
    return root


def write(root: Path, path: str, text: str) -> None:
    """Write a file of a checkout."""
    (root / path).parent.mkdir(parents=True, exist_ok=True)
    (root / path).write_text(text, encoding="utf-8")


def commit(root: Path, date: str) -> None:
    """Commit all files."""
    git(root, "add", "--all")
    git(root, "commit", "--allow-empty", "--message=change", f"--date={date}", date=date)


def delete_releases(root: Path) -> None:
    """Delete the tags of all releases."""
    for tag in ("v0.1.0", "v0.9.0", "v0.10.0"):
        git(root, "tag", "--delete", tag)


def git(root: Path, *words: str, date: str = "2026-01-03T12:00:00") -> str:
    """Run git with an identity and a date, and return what it prints."""
    identity = ["-c", "user.name=A", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false"]
    done = subprocess.run(
        ["git", *identity, *words],
        cwd=root,
        env={"PATH": "/usr/local/bin:/usr/bin:/bin", "GIT_COMMITTER_DATE": date},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


def read_cells(report: str) -> dict[str, list[str]]:
    """Cells of each row of the tables by its label."""
    rows = [line.strip("| ").split("|") for line in report.splitlines() if line.startswith("|")]
    return {label.strip(): [cell.strip() for cell in cells] for label, *cells in rows}


def test_the_report_stands_beside_the_last_release(checkout: Path, tmp_path: Path) -> None:
    before = git(checkout, "status", "--porcelain")
    junit = tmp_path / "tests.xml"
    junit.write_text('<testsuite><testcase time="1234.0"/><testcase time="0.6"/></testsuite>')

    report = write_report(checkout, beside=None, tests=junit, tests_beside=None)

    cells = read_cells(report)
    assert cells["code"][:4] == ["src/fingertip", "v0.10.0", "tools", "v0.10.0"]
    assert cells["modules"] == ["1", "1", "1", "0", "0", "0", "0", "0"]
    assert cells["lines of code"][:4] == ["2", "1", "1", "0"]
    assert cells["tokens of code"][:4] == ["13", "3", "3", "0"]
    assert cells["tokens a line"] == ["6.5", "3.0", "3.0", "-", "-", "-", "-", "-"]
    assert cells["packed assignments"][:4] == ["500.0", "0.0", "0.0", "-"]
    assert cells["texts and tests"] == ["now", "v0.10.0"]
    assert cells["words of README.md"] == ["4", "4"]
    assert cells["words of docs"] == ["5", "2"]
    assert cells["seconds of the tests"] == ["1 235", "-"]
    assert "--" not in report.splitlines()[-1]
    assert git(checkout, "status", "--porcelain") == before


def test_a_commit_is_named_where_there_is_no_release(checkout: Path) -> None:
    delete_releases(checkout)

    alone = write_report(checkout, beside=None, tests=None, tests_beside=None)
    assert read_cells(alone)["words of docs"] == ["5"]
    assert "name a commit with --beside" in alone
    assert "name a JUnit file with --tests" in alone

    beside = write_report(checkout, beside="HEAD~1", tests=None, tests_beside=None)
    assert read_cells(beside)["words of docs"] == ["5", "2"]
    assert "--beside" not in beside


def test_files_that_git_ignores_or_that_are_deleted_are_not_counted(checkout: Path) -> None:
    (checkout / "docs/a.md").unlink()
    assert sorted(read_checkout(checkout).texts) == [
        "README.md",
        "docs/more/c.md",
        "src/fingertip/a.py",
        "tools/new.py",
    ]
    assert sorted(read_commit(checkout, "v0.9.0").texts) == [
        "README.md",
        "docs/a.md",
        "src/fingertip/a.py",
    ]


def test_the_last_release_is_the_newest_tag_of_a_version(checkout: Path) -> None:
    assert find_last_release(checkout) == "v0.10.0"


@pytest.mark.every_case
@pytest.mark.parametrize("name", ["missing", "--list", ""])
def test_a_commit_that_does_not_exist_is_refused(checkout: Path, name: str) -> None:
    with pytest.raises(GrainError, match=r"no commit .* --beside HEAD"):
        read_commit(checkout, name)


def test_times_of_the_other_commit_need_one(checkout: Path, tmp_path: Path) -> None:
    delete_releases(checkout)
    junit = tmp_path / "tests.xml"
    junit.write_text('<testsuite><testcase time="1.0"/></testsuite>')
    with pytest.raises(GrainError, match="add --beside COMMIT"):
        write_report(checkout, beside=None, tests=None, tests_beside=junit)


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("text", "problem"),
    [(None, "cannot be read"), ("", "is no JUnit file"), ("<testsuite/>", "holds no test")],
)
def test_a_file_without_times_is_refused(text: str | None, problem: str, tmp_path: Path) -> None:
    path = tmp_path / "tests.xml"
    if text is not None:
        path.write_text(text)
    with pytest.raises(GrainError, match=f"{problem}.*--junit-xml="):
        read_seconds(path)


def test_the_command_says_what_is_wrong_in_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match=r"^grain: .* cannot be read"):
        main(["--tests", str(tmp_path / "missing.xml")])


def test_columns_of_a_table_are_aligned() -> None:
    assert write_table([["a", "number"], ["longer", "1"]]) == (
        "| a      | number |\n| ------ | -----: |\n| longer |      1 |\n"
    )
