"""Pages, messages, names and comments are spelled as a dictionary of common misspellings has it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md", "docs")
CODE = ("mimics_app", "assets/builders", "scenes")
RIGHT = (
    "acn", "befores", "commun", "fle", "fro", "hart", "lod", "mapp", "nwe", "planed", "setts", "shepperd", "statics",
    "strack", "trough", "wit",
)  # fmt: skip
"""Names, terms and abbreviations that the dictionary takes for misspellings."""


def misspelled(*places: Path | str) -> list[str]:
    skip = "*.svg,*.jpg,*.png,*.pyc,*.npz,*.po,*.mo,*.html,*.js,*/data/*"
    command = [sys.executable, "-m", "codespell_lib", "--skip", skip, "--ignore-words-list", ",".join(RIGHT), *places]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True).stdout.splitlines()


def test_nothing_is_misspelled() -> None:
    assert not misspelled(*PAGES, *CODE)


def test_a_misspelled_word_is_found(tmp_path: Path) -> None:
    (tmp_path / "page.md").write_text("The hand recieves a force.\n")
    assert len(misspelled(tmp_path)) == 1
