"""What only drivers in software need: the page of its decision lists every file, with its lines, and it stays small."""

from __future__ import annotations

import re

from tests.architecture.sources import ROOT

ROOM = ROOT / "mimics_app" / "rendering" / "visual" / "software"
PAGE = ROOT / "docs" / "decisions" / "118-software-rendering.md"

MOST_LINES = 3500
"""Lines that the parts may have together: each has to be worth its place, see the page."""


def test_the_table_lists_every_file_and_no_other_and_counts_its_lines() -> None:
    rows = re.findall(r"^\| (.+?) \| .* \| (\d+) \|$", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    named = {name for part, _ in rows for name in re.findall(r"`(\w+)(?:: \w+)?`", part) if name.islower()}
    files = {file.stem: file for file in ROOM.rglob("*.py") if file.stem != "__init__"}
    assert set(files) <= named, "a part without a row"
    assert named - set(files) <= {"mallopt", "keep_freed_memory"}, "no longer a file"
    total = sum(len(file.read_text(encoding="utf-8").splitlines()) for file in ROOM.rglob("*.py"))
    assert total <= MOST_LINES
    assert abs(sum(int(lines) for _, lines in rows) - total) <= 0.03 * total, "count the lines of the table again"
