"""What the README lets people type is accepted, and what it points to is there."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from mimics_app.app.cli import COMMANDS, parse

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "SECURITY.md", *sorted((ROOT / "docs").rglob("*.md"))]


def _typed(page: Path) -> list[str]:
    """The command lines in the shell snippets of a page, without comments and redirections."""
    blocks = re.findall(r"```sh\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    lines = [line.split("#")[0].split(" > ")[0].strip() for block in blocks for line in block.splitlines()]
    return [line for line in lines if line]


SNIPPETS = [(page.name, line) for page in PAGES for line in _typed(page)]


@pytest.mark.parametrize(("page", "line"), SNIPPETS)
def test_snippet_can_be_typed(page: str, line: str) -> None:
    words = shlex.split(line)
    if words[0] == "make":
        assert re.search(rf"^[a-z -]*\b{re.escape(words[1])}\b[a-z -]*:", (ROOT / "Makefile").read_text(), re.MULTILINE)
        given = [word.removeprefix("ARGS=") for word in words[2:]]
        words = ["mimics", "run", "scenes/wavy_tunnel.json", *shlex.split(" ".join(given))]
    assert words[0] == "mimics"
    if len(words) > 1:
        args = parse(words[1:])
        assert args.command == words[1]
    for word in words:
        if word.startswith("scenes/"):
            assert (ROOT / word).is_file()


def test_snippets_are_found() -> None:
    """The test above can fail: an unreadable README would leave it without cases."""
    assert len(SNIPPETS) > 8


def test_every_command_stands_in_the_table() -> None:
    rows = re.findall(r"^\| `mimics (\w+)", (ROOT / "README.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert set(rows) == set(COMMANDS)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    links = re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text(encoding="utf-8"))
    assert not [link for link in links if "://" not in link and not (page.parent / link).exists()]


def test_version_is_the_same_everywhere() -> None:
    from mimics_app import __version__

    assert f"version: {__version__}" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"## {__version__}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_licence_is_apache_and_names_the_holders() -> None:
    text = (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert "Apache License" in text
    assert "Version 2.0" in text
    assert "Copyright mimics_app contributors" in text


STAGES = ("dsp", "estimation", "learning", "inputs.physio")
EMPTY = {"__init__.py", "stage.py", "null.py", "action_sequence.py"}
"""Files of a stage that passes nothing on; the last replays actions from a file, which the figure says."""


def _not_built() -> set[str]:
    folders = {name: ROOT / "mimics_app" / name.replace(".", "/") for name in STAGES}
    return {name for name, folder in folders.items() if {file.name for file in folder.rglob("*.py")} <= EMPTY}


def test_the_figure_says_which_stages_are_not_built() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert "Every stage is implemented." in text and _not_built() == set()
