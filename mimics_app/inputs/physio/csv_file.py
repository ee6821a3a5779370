"""Columns of numbers of a CSV file, read in batches of rows, so that a long recording need not fit into memory."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import Issue, SceneError, first_line
from mimics_app.contracts.system.regular_file import open_regular

if TYPE_CHECKING:
    import pyarrow as pa
    from _typeshed import WriteableBuffer

__all__ = ["CsvFile"]

_BOM = b"\xef\xbb\xbf"
_LONGEST_HEADER = 1 << 16
_MOST_COLUMNS = 4096
_BATCH = 1 << 20
"""Bytes of text that are parsed at once; a row is shorter."""
_MOST_RATIO = 64
"""Largest ratio of a compressed file; tables of measurements have 3 to 10."""
_ROOM = 64 << 20
"""Text beyond that ratio that is allowed [bytes]."""
_EMPTY = ["", "nan", "NaN", "NA", "N/A", "n/a", "null", "NULL", "#N/A", "#NV", "-", "--"]
"""Cells without a value."""
_SEPARATORS = (",", ";", "\t")
_COMMA = re.compile(r"^\s*[-+]?\d*,\d+(e[-+]?\d+)?\s*$", re.IGNORECASE)
"""A number with a decimal comma, as spreadsheets of many countries write it."""
_FEW_ROWS = 20
"""Rows in which such a number is looked for."""
_OF_COLUMN = re.compile(r"column #(\d+)")
_OF_ROW = re.compile(r"Row #(\d+)")
_VALUE = re.compile(r"invalid value '([^']*)'")


class CsvFile:
    """A table with named columns, which may be compressed (.csv.gz, .bz2, .zst, .lz4).

    Args:
        path: The file.

    Attributes:
        labels: Names of the columns.

    Raises:
        SceneError: It cannot be read, or its first row is too long.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._separator, self._point = ",", "."
        with self._opened() as stream:
            self.labels = self._header(stream)
            if self._separator != ",":
                self._point = self._decimal_point(stream)

    def batches(self, columns: Sequence[int]) -> Iterator[list[F8]]:
        """Yield some columns as float64, NaN where a cell is empty, a batch of rows at a time.

        Raises:
            SceneError: A row has another number of columns, or a cell is not a number.
        """
        import pyarrow as pa
        from pyarrow import csv as arrow_csv

        names = [str(number) for number in range(len(self.labels))]
        wanted = [names[column] for column in columns]
        reading = arrow_csv.ReadOptions(use_threads=False, block_size=_BATCH, column_names=names)
        parsing = arrow_csv.ParseOptions(delimiter=self._separator)
        types = dict.fromkeys(wanted, pa.float64())
        converting = arrow_csv.ConvertOptions(
            column_types=types, include_columns=wanted, null_values=_EMPTY, decimal_point=self._point
        )
        before = 0
        with self._opened() as stream:
            self._header(stream)
            try:
                for rows in self._rows(stream):
                    table = arrow_csv.read_csv(_arrow_memory(rows), reading, parsing, converting)
                    yield [table.column(n).to_numpy() for n in range(len(wanted))]
                    before += table.num_rows
            except (pa.ArrowException, ValueError) as error:
                raise self._refused(error, before) from error

    @staticmethod
    def _rows(stream: io.BufferedReader) -> Iterator[bytes]:
        """Yield the text of whole rows, about a batch at a time."""
        rest, empty = b"", True
        while text := stream.read(_BATCH - len(rest)):
            rows, end, rest = (rest + text).rpartition(b"\n")
            if rows.strip(b"\r\n"):
                empty = False
                yield rows + end
        if len(rest) >= _BATCH:
            raise ValueError(f"a row has more than {_BATCH} characters")
        if rest.strip(b"\r"):
            yield rest
        elif empty:
            raise ValueError("it has no rows")

    @contextmanager
    def _opened(self) -> Iterator[io.BufferedReader]:
        """Open the text of the file."""
        import pyarrow as pa

        try:
            with open_regular(self._path) as file:
                size = file.seek(0, io.SEEK_END)
                file.seek(0)
                suffix = self._path.suffix.lower()
                codec = None if suffix == ".csv" else pa.Codec.detect(self._path.name).name
                text: IO[bytes] = file if codec is None else pa.CompressedInputStream(pa.PythonFile(file, "r"), codec)
                limit = None if codec is None else _MOST_RATIO * size + _ROOM
                yield io.BufferedReader(_Text(text, limit), _BATCH)
        except (pa.ArrowException, OSError, ValueError) as error:
            raise self._refused(error) from error

    def _header(self, stream: io.BufferedReader) -> list[str]:
        """Read the first row that is not empty, and note by what its names are separated."""
        line = b"\n"
        while line and (not line.strip() or line.lower().lstrip(_BOM).startswith(b"sep=")):
            line = stream.readline(_LONGEST_HEADER + 1)
        if len(line) > _LONGEST_HEADER:
            raise SceneError(Issue(str(self._path), "", f"its first row has more than {_LONGEST_HEADER} characters"))
        try:
            text = line.removeprefix(_BOM).decode("utf-8")
        except UnicodeDecodeError:
            text = line.removeprefix(_BOM).decode("latin-1")
        text = text.strip("\r\n")
        self._separator = max(_SEPARATORS, key=text.count)
        try:
            labels = next(csv.reader([text], delimiter=self._separator), [])
        except csv.Error as error:
            raise self._refused(error) from error
        if not labels or len(labels) > _MOST_COLUMNS:
            what = "it is empty" if not labels else f"it has more than {_MOST_COLUMNS} columns"
            raise SceneError(Issue(str(self._path), "", what))
        return labels

    def _decimal_point(self, stream: io.BufferedReader) -> str:
        """Return the decimal point of the first rows."""
        for _ in range(_FEW_ROWS):
            row = stream.readline(_LONGEST_HEADER).decode("latin-1")
            if any(_COMMA.match(cell.strip('"')) for cell in row.split(self._separator)):
                return ","
        return "."

    def _refused(self, error: Exception, before: int = 0) -> SceneError:
        """Return an error as one of this file; `before`: rows before the batch in which it occurred."""

        def counted(text: str) -> str:
            return _OF_ROW.sub(lambda row: f"Row #{int(row[1]) + before}", text)

        text = counted(str(error))
        column, row, value = _OF_COLUMN.search(text), _OF_ROW.search(text), _VALUE.search(text)
        if column and "conversion error" in text:
            where = f"row {row[1]} of the column" if row else "the column"
            held = f'"{value[1]}"' if value else "something"
            what = f"{where} holds {held}, which is not a number"
            fix = "leave a cell empty where a value is missing"
            return SceneError(Issue(str(self._path), f"/{self.labels[int(column[1])]}", what, fix))
        why = getattr(error, "strerror", "") or counted(first_line(error))
        return SceneError(Issue(str(self._path), "", f"it cannot be read: {why}"))


def _arrow_memory(text: bytes) -> pa.BufferReader:
    """Copy text to memory of Arrow, whose threads read ahead: they would call into Python for any of ours.

    What they do there cannot be waited for, and Python 3.11 crashes if `tracemalloc` is stopped meanwhile.
    """
    import pyarrow as pa

    memory = pa.BufferOutputStream()
    memory.write(text)
    return pa.BufferReader(memory.getvalue())


class _Text(io.RawIOBase):
    """The text of a file; one that unpacks to far more than its size is no table of measurements."""

    def __init__(self, source: IO[bytes], limit: int | None) -> None:
        self._source, self._left = source, limit

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: WriteableBuffer, /) -> int:
        room = memoryview(buffer).cast("B")
        data = self._source.read(len(room))
        if self._left is not None:
            self._left -= len(data)
            if self._left < 0:
                raise OSError(f"it unpacks to more than {_MOST_RATIO} times its size")
        room[: len(data)] = data
        return len(data)
