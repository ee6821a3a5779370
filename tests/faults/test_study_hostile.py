"""What comes from elsewhere and ends in a table, on a terminal or in a file: it runs, forges and leaks nothing."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from mimics_app.app.cli import main
from mimics_app.app.physio.watch import Watch
from mimics_app.app.study.page import write_page
from mimics_app.app.study.subjects import SubjectRun, find_run
from mimics_app.app.study.tables import write_table
from mimics_app.app.terminal.output import issue_lines, say
from mimics_app.contracts.errors import Issue

RUN = Path(__file__).parents[1] / "data" / "run_0_1_0"
CONTROL = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069]")
"""Everything but a line's end that a terminal may take as an order."""
ESCAPES = "\x1b[31mred\x1b]0;title\x07\r\x9b2Jclear\x08\u202eturned\nmimics: verified"


@pytest.mark.parametrize(
    "seed", ["Infinity", "-Infinity", "NaN", "1e999", '"x"', "null", "[]", "{}", "1" * 5000, "[" * 9000]
)
def test_a_header_with_any_seed_is_a_run_or_a_problem(tmp_path: Path, seed: str) -> None:
    header = '{"scene": {"name": "walk"}, "settings": {}, "moved_by": {}, "seed": '
    (tmp_path / "session.json").write_text(header + seed + "}")
    assert "not a run folder" in find_run(1, tmp_path, "walk").problem


def test_a_pipe_in_a_run_folder_is_a_problem(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "session.json")
    assert "not a run folder" in find_run(1, tmp_path, "walk").problem


FORMULAS = [
    "=1+1",
    "=cmd|'/C calc'!A0",
    "+cmd",
    "-2+3",
    "@SUM(A1)",
    "\t=1",
    "\r=1",
    "\n=1",
    "  =1",
    "\uff1d1",
    "-",
    "+.e1",
]
PLAIN = ["-0.25", "+1e-3", "3", "", "P07", "a=b", "Muller, A", 'say "no"', "2026-11-29", "-.5", "'=1"]


def test_no_cell_of_a_table_is_a_formula(tmp_path: Path) -> None:
    """A spreadsheet runs what begins with one of four signs, blanks aside; a number may begin with two of them."""
    rows = [{"subject": n, text: text, "x": -0.25} for n, text in enumerate([*FORMULAS, *PLAIN])]
    write_table(tmp_path / "table.csv", rows)
    with (tmp_path / "table.csv").open(newline="", encoding="utf-8") as file:
        cells = [cell for row in csv.reader(file) for cell in row]
    assert len(cells) > len(rows) ** 2
    for cell in cells:
        first = cell.replace("\xa0", " ").lstrip(" ")[:1]
        if first and first in "=+-@\t\r\n\uff1d\uff0b\uff0d\uff20":
            float(cell)
    assert {*PLAIN, "-0.25"} <= {*cells}, "what is no formula is unchanged"
    assert {f"'{text}" for text in FORMULAS} <= {*cells}


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_tables_and_pages_are_for_their_user_alone(tmp_path: Path) -> None:
    before = os.umask(0o022)
    try:
        old = tmp_path / "old.csv"
        old.write_text("readable by all")
        os.chmod(old, 0o644)
        for file in (tmp_path / "new.csv", old):
            write_table(file, [{"a": 1}])
        write_page(tmp_path / "study.html", "walk", [SubjectRun(1, 1, None, "gone")], [], {})
        files = [old, tmp_path / "new.csv", tmp_path / "study.html"]
        Watch().write_events(tmp_path / "events.csv")
        Watch().write_features(tmp_path / "features.csv")
        files += [tmp_path / "events.csv", tmp_path / "features.csv"]
        assert main(["study", "avatar_cord", "--of", str(RUN), "--out", str(tmp_path / "out")]) == 6
    finally:
        os.umask(before)
    assert mode(tmp_path / "out") == 0o700
    files += list((tmp_path / "out").iterdir())
    assert len(files) == 7 and {mode(file) for file in files} == {0o600}


@pytest.mark.parametrize("command", [["record", "info"], ["record", "verify"], ["report"], ["study", "walk", "--of"]])
def test_a_run_folder_gives_a_terminal_no_orders(
    tmp_path: Path, command: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "run"
    shutil.copytree(RUN, folder)
    for name in ("manifest.json", "session.json"):
        read = json.loads((folder / name).read_text())
        read |= {"problem": ESCAPES, "lost": [ESCAPES]}
        read["status"] = read.get("status", ESCAPES)
        read["scene"] = {**read.get("scene", {}), "name": ESCAPES, "title": ESCAPES}
        (folder / name).write_text(json.dumps(read))
    out = ["--out", str(tmp_path / "out")] if command[0] == "study" else []
    scene = [str(tmp_path / "walk.json") if word == "walk" else word for word in command]
    (tmp_path / "walk.json").write_text('{"format": "mimics-scene", "version": 1, "title": "walk"}')
    main([*scene, str(folder), *out])
    shown = capsys.readouterr()
    text = shown.out + shown.err
    assert "red" in text or command[0] == "report"
    assert not CONTROL.search(text), f"{CONTROL.search(text)}"
    assert not any(line.startswith("mimics: verified") for line in text.splitlines())


def test_what_is_said_is_one_line_without_orders_and_not_endless(capsys: pytest.CaptureFixture[str]) -> None:
    say(f"looking for {'x' * 5000}")
    say(ESCAPES)
    text = capsys.readouterr().err
    assert len(text) < 400 and text.count("\n") == 2 and not CONTROL.search(text)
    assert not CONTROL.search("".join(issue_lines([Issue("f", "", ESCAPES)])))


@pytest.mark.parametrize("kind", ["lsl", "serial", "board", "sim", "file"])
def test_a_source_of_5000_characters_is_not_echoed(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    if kind in ("lsl", "board"):
        pytest.importorskip({"lsl": "pylsl", "board": "brainflow"}[kind])
    assert main(["physio", f"{kind}:{'x' * 5000}", "--seconds", "0.1"]) != 0
    assert len(capsys.readouterr().err) < 1200


def test_what_a_library_of_c_prints_does_not_follow_the_object() -> None:
    """It is held in a buffer of the library while the command runs, and is written when the process ends."""
    code = (
        (
            "import ctypes\\n"
            "from mimics_app.app.terminal.output import reserved_stdout, write_object\\n"
            "with reserved_stdout():\\n"
            "    ctypes.CDLL(None).printf(b'filesize 1234\\\\n')\\n"
            "    write_object('test', {})\\n"
        )
        .replace("\\n", "\n")
        .replace("\\\\n", "\\n")
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert json.loads(done.stdout)["command"] == "test"
    assert "filesize 1234" in done.stderr
