"""trials.csv: one row per finished trial, on the medium before the next trial starts.

A cell is the JSON text of its value; strings stand as they are unless that would read back as something else. Empty
strings and None are empty cells.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mimics_app.recording.append_file import AppendFile
from mimics_app.recording.run_folder import write_atomically

__all__ = ["TrialTable", "read_trials"]


class TrialTable:
    """Appends rows to trials.csv; a row with a new column rewrites the small file in one step.

    Attributes:
        rows: What the file holds.
    """

    def __init__(self, path: Path, *, resume: bool = False) -> None:
        self._path = path
        self.rows: list[dict[str, Any]] = read_trials(path) if resume else []
        self._columns = _columns(self.rows)
        if resume:
            write_atomically(path, self._text())
        self._file = AppendFile(path, resume_at=path.stat().st_size if resume else None)

    def append(self, row: Mapping[str, object]) -> None:
        """Write one row and bring it onto the medium.

        Raises:
            OSError: The disk is full or failed; the file is as it was before.
        """
        columns = _columns([*self.rows, row])
        if columns == self._columns:
            self._file.append(_line([_cell(row.get(name)) for name in columns]))
            self._file.sync()
            self.rows.append(dict(row))
            return
        before, self._columns = self._columns, columns
        self.rows.append(dict(row))
        try:
            write_atomically(self._path, self._text())
        except OSError:
            self._columns = before
            self.rows.pop()
            raise
        self._file.close()
        self._file = AppendFile(self._path, resume_at=self._path.stat().st_size)

    def close(self) -> None:
        """Let the file go."""
        self._file.close()

    def _text(self) -> bytes:
        lines = [_line(self._columns)] if self._columns else []
        lines += [_line([_cell(row.get(name)) for name in self._columns]) for row in self.rows]
        return b"".join(lines)


def read_trials(path: Path) -> list[dict[str, Any]]:
    """Rows of a trials.csv as plain values; empty cells are left out, and so is a row that was cut off."""
    if not path.exists():
        return []
    content = path.read_bytes()
    whole = content[: content.rfind(b"\n") + 1].decode("utf-8", "replace").replace("\0", "")
    table = list(csv.reader(io.StringIO(whole)))
    if not table:
        return []
    names = table[0]
    return [
        {name: _value(cell) for name, cell in zip(names, row, strict=True) if cell != ""}
        for row in table[1:]
        if len(row) == len(names)
    ]


def _columns(rows: list[dict[str, Any]] | list[Mapping[str, object]]) -> list[str]:
    return list(dict.fromkeys(name for row in rows for name in row))


def _line(cells: list[str]) -> bytes:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue().encode()


def _cell(value: object) -> str:
    if value is None or value == "":
        return ""
    if isinstance(value, str) and _value(value) is value:
        return value
    return json.dumps(value)


def _value(cell: str) -> Any:
    try:
        return json.loads(cell)
    except ValueError:
        return cell
