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
from mimics_app.contracts.regular_file import open_regular

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

__all__ = ["CsvFile"]

_LONGEST_HEADER = 1 << 16
_MOST_COLUMNS = 4096
_BATCH = 1 << 20
"""Bytes of text that are parsed at once; a row is shorter."""
_MOST_RATIO = 64
"""Largest ratio of a compressed file; tables of measurements have 3 to 10."""
_ROOM = 64 << 20
"""Text beyond that ratio that is allowed [bytes]."""
_EMPTY = ["", "nan", "NaN", "NA", "null"]
"""Cells without a value."""
_OF_COLUMN = re.compile(r"column #(\d+)")


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
        with self._opened() as stream:
            self.labels = self._header(stream)

    def batches(self, columns: Sequence[int]) -> Iterator[list[F8]]:
        """Yield some columns as float64, NaN where a cell is empty, a batch of rows at a time.

        Raises:
            SceneError: A row has another number of columns, or a cell is no number.
        """
        import pyarrow as pa
        from pyarrow import csv as arrow_csv

        names = [str(number) for number in range(len(self.labels))]
        wanted = [names[column] for column in columns]
        with self._opened() as stream:
            self._header(stream)
            types = dict.fromkeys(wanted, pa.float64())
            try:
                reader = arrow_csv.open_csv(
                    stream,
                    arrow_csv.ReadOptions(use_threads=False, block_size=_BATCH, column_names=names),
                    convert_options=arrow_csv.ConvertOptions(
                        column_types=types, include_columns=wanted, null_values=_EMPTY
                    ),
                )
                for batch in reader:
                    yield [batch.column(n).to_numpy(zero_copy_only=False) for n in range(len(wanted))]
            except StopIteration:
                return
            except (pa.ArrowException, ValueError) as error:
                raise self._refused(error) from error

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
        """Read the first row that is not empty."""
        line = b"\n"
        while line and not line.strip():
            line = stream.readline(_LONGEST_HEADER + 1)
        if len(line) > _LONGEST_HEADER:
            raise SceneError(Issue(str(self._path), "", f"its first row has more than {_LONGEST_HEADER} characters"))
        try:
            text = line.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = line.decode("latin-1")
        labels = next(csv.reader([text.strip("\r\n")]), [])
        if not labels or len(labels) > _MOST_COLUMNS:
            what = "it is empty" if not labels else f"it has more than {_MOST_COLUMNS} columns"
            raise SceneError(Issue(str(self._path), "", what))
        return labels

    def _refused(self, error: Exception) -> SceneError:
        column = _OF_COLUMN.search(str(error))
        if column and "conversion error" in str(error):
            return SceneError(
                Issue(str(self._path), f"/{self.labels[int(column[1])]}", "the column holds more than numbers")
            )
        return SceneError(
            Issue(str(self._path), "", f"it cannot be read: {getattr(error, 'strerror', '') or first_line(error)}")
        )


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
