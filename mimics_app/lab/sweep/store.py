"""Finished chunks of a sweep on disk, and the Parquet file that they are joined to.

The name of a chunk is a digest of everything its content depends on: the sweep, the program's sources, its points. A
chunk is written atomically, hence complete or absent whenever the program is killed.
"""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.contracts.system.whole_file import whole_file
from mimics_app.lab.sweep.quantity import Columns, Kind, SweepExperiment
from mimics_app.lab.sweep.spec import Sweep

if TYPE_CHECKING:
    import pyarrow

__all__ = ["Chunk", "ChunkStore", "chunks_of", "pack", "source_digest"]

Chunk = tuple[int, int]
"""First point of a chunk, and the point after the last."""

_ROWS_PER_GROUP = 1 << 16


@cache
def source_digest() -> str:
    """Return the SHA-256 of all Python files of the package and of the versions of numba and numpy, in hexadecimal."""
    import numba
    import numpy as np

    package = Path(__file__).resolve().parents[2]
    digest = hashlib.sha256(f"numba {numba.__version__} numpy {np.__version__}".encode())
    for source in sorted(package.rglob("*.py")):
        digest.update(source.relative_to(package).as_posix().encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()


def chunks_of(points: int, size: int) -> list[Chunk]:
    """Return the chunks of a sweep."""
    return [(start, min(start + size, points)) for start in range(0, points, size)]


def pack(sweep: Sweep, experiment: SweepExperiment, chunk: Chunk, values: Columns, results: Columns) -> bytes:
    """Return a finished chunk as Arrow data: point, parameters in the order of their names, results."""
    import pyarrow as pa

    kinds: dict[str, Kind] = {name: experiment.kind(name) for name in sorted(values)}
    columns: dict[str, Sequence[Any]] = {"point": range(*chunk), **{name: values[name] for name in kinds}}
    kinds = {"point": "int", **kinds, **experiment.results}
    columns.update({name: results[name] for name in experiment.results})
    types = {"float": pa.float64(), "int": pa.int64(), "text": pa.string(), "bool": pa.bool_()}
    schema = pa.schema([(name, types[kind]) for name, kind in kinds.items()])
    table = pa.table({name: pa.array(columns[name], types[kinds[name]]) for name in kinds}, schema=schema)
    sink = pa.BufferOutputStream()
    with pa.ipc.new_file(sink, schema) as writer:
        writer.write_table(table.combine_chunks())
    return bytes(sink.getvalue())


class ChunkStore:
    """Folder of finished chunks beside the result.

    Args:
        out: The Parquet file of the sweep.
        identity: Digest of everything the chunks depend on except their points.
    """

    def __init__(self, out: Path, identity: str) -> None:
        self._out = out
        self._identity = identity
        self.folder = out.with_name(f"{out.name}.pieces")

    def has(self, chunk: Chunk) -> bool:
        """Whether a chunk is present and complete."""
        return self._read(chunk) is not None

    def put(self, chunk: Chunk, data: bytes) -> None:
        """Store a finished chunk."""
        self.folder.mkdir(parents=True, exist_ok=True)
        _write_whole(self._file(chunk), data)

    def finish(self, chunks: Sequence[Chunk], sweep: Sweep) -> Path:
        """Join the chunks in the order of their points to one Parquet file, remove them and return its path.

        The bytes of the file depend on the points alone, neither on the order nor on the size of the chunks.

        Raises:
            KeyError: A chunk is missing.
        """
        import pyarrow as pa
        import pyarrow.parquet as pq

        tables = []
        for chunk in chunks:
            table = self._read(chunk)
            if table is None:
                raise KeyError(f"points {chunk[0]} to {chunk[1] - 1} are missing in {self.folder}")
            tables.append(table)
        joined = pa.concat_tables(tables).combine_chunks()
        joined = joined.replace_schema_metadata({"mimics.sweep": sweep.canonical, "mimics.identity": self._identity})
        sink = pa.BufferOutputStream()
        pq.write_table(joined, sink, compression="zstd", row_group_size=_ROWS_PER_GROUP)
        _write_whole(self._out, bytes(sink.getvalue()))
        shutil.rmtree(self.folder, ignore_errors=True)
        return self._out

    def _file(self, chunk: Chunk) -> Path:
        name = hashlib.sha256(f"{self._identity}/{chunk[0]}/{chunk[1]}".encode()).hexdigest()
        return self.folder / f"{name}.arrow"

    def _read(self, chunk: Chunk) -> pyarrow.Table | None:
        import pyarrow as pa

        file = self._file(chunk)
        try:
            table = pa.ipc.open_file(pa.py_buffer(read_regular(file))).read_all()
        except (OSError, pa.ArrowInvalid):
            return None
        return table if table.num_rows == chunk[1] - chunk[0] else None


def _write_whole(file: Path, data: bytes) -> None:
    """Write a file atomically, also with respect to a power failure."""
    file.parent.mkdir(parents=True, exist_ok=True)
    partial = file.with_name(f"{file.name}.{os.getpid()}.partial")
    with whole_file(partial), partial.open("wb") as stream:
        stream.write(data)
        stream.flush()
        os.fsync(stream.fileno())
    partial.replace(file)
