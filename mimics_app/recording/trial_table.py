"""trials.csv: one row per finished trial, on the medium before the next trial starts.

A cell is the JSON text of its value; strings are written without quotes unless that would be read as another value.
Empty strings and None are empty cells.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.recording.append_file import AppendFile
from mimics_app.recording.event_log import to_json
from mimics_app.recording.run_folder import write_atomically

__all__ = ["TrialTable", "as_read", "read_table", "read_trials", "table_text"]


class TrialTable:
    """Writer of trials.csv; a row with a new column rewrites the small file atomically.

    Attributes:
        rows: Rows of the file.
    """

    def __init__(self, path: Path, *, resume: bool = False) -> None:
        self._path = path
        self.rows: list[dict[str, Any]] = read_trials(path) if resume else []
        self._columns = _columns(self.rows)
        if resume:
            write_atomically(path, table_text(self.rows))
        self._file = AppendFile(path, resume_at=path.stat().st_size if resume else None)

    def append(self, row: Mapping[str, object]) -> None:
        """Write one row and flush it to the medium.

        Raises:
            OSError: The disk is full or failed; the file is unchanged.
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
            write_atomically(self._path, table_text(self.rows))
        except OSError:
            self._columns = before
            self.rows.pop()
            raise
        self._file.close()
        self._file = AppendFile(self._path, resume_at=self._path.stat().st_size)

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def table_text(rows: Sequence[Mapping[str, object]]) -> bytes:
    """Return the content of a trials.csv with these rows."""
    columns = _columns(rows)
    lines = [_line(columns)] if columns else []
    return b"".join([*lines, *(_line([_cell(row.get(name)) for name in columns]) for row in rows)])


def as_read(row: Mapping[str, object]) -> dict[str, Any]:
    """Return a row as it is read after writing: plain values, without empty cells."""
    cells = {name: _cell(value) for name, value in json.loads(to_json(row)).items()}
    return {name: _value(cell) for name, cell in cells.items() if cell != ""}


def read_trials(path: Path) -> list[dict[str, Any]]:
    """Return the rows of a trials.csv as plain values, without empty cells; [] without the file.

    Raises:
        OSError: It cannot be read.
    """
    return read_table(path)[0] if path.exists() else []


def read_table(path: Path) -> tuple[list[dict[str, Any]], int]:
    """Return the valid rows of a trials.csv, and the number of invalid ones: cut off, too long, or misaligned.

    Raises:
        OSError: The file is missing or cannot be read.
    """
    content = read_regular(path)
    end = content.rfind(b"\n") + 1
    whole = content[:end].decode("utf-8", "replace").replace("\0", "")
    table, bad = _csv_rows(whole)
    bad += bool(content[end:].strip())
    if not table:
        return [], bad
    names = table[0]
    rows = [
        {name: _value(cell) for name, cell in zip(names, row, strict=True) if cell != ""}
        for row in table[1:]
        if len(row) == len(names)
    ]
    return rows, bad + len(table) - 1 - len(rows)


def _csv_rows(text: str) -> tuple[list[list[str]], int]:
    """Return the rows of a table, and the number of those that the CSV reader rejects."""
    reader = csv.reader(io.StringIO(text, newline=""))
    rows: list[list[str]] = []
    bad = 0
    while True:
        try:
            rows.append(next(reader))
        except StopIteration:
            return rows, bad
        except csv.Error:
            bad += 1


def _columns(rows: Sequence[Mapping[str, object]]) -> list[str]:
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
        value = json.loads(cell)
        json.dumps(value, ensure_ascii=False).encode()
    except (ValueError, RecursionError):  # no JSON, no text UTF-8 can hold, or too deep
        return cell
    return value
