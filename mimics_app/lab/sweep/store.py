"""Finished pieces of a sweep on disk, and the one Parquet file they become.

A piece is named after everything its content depends on: the sweep, the program's sources, the points in it. It is
written beside its place and moved there, so that a piece is whole or absent, whenever the program was killed.
"""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.lab.sweep.quantity import Columns, Kind, SweepExperiment
from mimics_app.lab.sweep.spec import Sweep

if TYPE_CHECKING:
    import pyarrow

__all__ = ["Piece", "PieceStore", "pack", "pieces_of", "source_digest"]

Piece = tuple[int, int]
"""First point, and the one behind the last."""

_ROWS_PER_GROUP = 1 << 16


@cache
def source_digest() -> str:
    """SHA-256 over every Python file of the package and the versions of what computes, in hexadecimal."""
    import numba
    import numpy as np

    package = Path(__file__).resolve().parents[2]
    digest = hashlib.sha256(f"numba {numba.__version__} numpy {np.__version__}".encode())
    for source in sorted(package.rglob("*.py")):
        digest.update(source.relative_to(package).as_posix().encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()


def pieces_of(points: int, chunk: int) -> list[Piece]:
    """The points of a sweep cut into pieces."""
    return [(start, min(start + chunk, points)) for start in range(0, points, chunk)]


def pack(sweep: Sweep, experiment: SweepExperiment, piece: Piece, values: Columns, results: Columns) -> bytes:
    """One finished piece as Arrow data: point, parameters in the order of their names, results."""
    import pyarrow as pa

    kinds: dict[str, Kind] = {name: _kind_of(experiment, name) for name in sorted(values)}
    columns: dict[str, Sequence[Any]] = {"point": range(*piece), **{name: values[name] for name in kinds}}
    kinds = {"point": "int", **kinds, **experiment.results}
    columns.update({name: results[name] for name in experiment.results})
    types = {"float": pa.float64(), "int": pa.int64(), "text": pa.string(), "bool": pa.bool_()}
    schema = pa.schema([(name, types[kind]) for name, kind in kinds.items()])
    table = pa.table({name: pa.array(columns[name], types[kinds[name]]) for name in kinds}, schema=schema)
    sink = pa.BufferOutputStream()
    with pa.ipc.new_file(sink, schema) as writer:
        writer.write_table(table.combine_chunks())
    return bytes(sink.getvalue())


def _kind_of(experiment: SweepExperiment, name: str) -> Kind:
    quantity = experiment.quantity(name)
    return "float" if quantity is None else quantity.kind


class PieceStore:
    """The folder of finished pieces beside the result.

    Args:
        out: The Parquet file the sweep becomes.
        identity: Digest of what the pieces depend on, beside their points.
    """

    def __init__(self, out: Path, identity: str) -> None:
        self._out = out
        self._identity = identity
        self.folder = out.with_name(f"{out.name}.pieces")

    def has(self, piece: Piece) -> bool:
        """Whether a piece is there, whole."""
        return self._read(piece) is not None

    def put(self, piece: Piece, data: bytes) -> None:
        """Keep a finished piece."""
        self.folder.mkdir(parents=True, exist_ok=True)
        _write_whole(self._file(piece), data)

    def finish(self, pieces: Sequence[Piece], sweep: Sweep) -> Path:
        """Join the pieces in the order of their points into one Parquet file, and remove them.

        The bytes of the file depend on the points alone: not on the order in which pieces came, nor on their size.

        Raises:
            KeyError: A piece is missing.
        """
        import pyarrow as pa
        import pyarrow.parquet as pq

        tables = []
        for piece in pieces:
            table = self._read(piece)
            if table is None:
                raise KeyError(f"points {piece[0]} to {piece[1] - 1} are missing in {self.folder}")
            tables.append(table)
        joined = pa.concat_tables(tables).combine_chunks()
        joined = joined.replace_schema_metadata({"mimics.sweep": sweep.canonical, "mimics.identity": self._identity})
        sink = pa.BufferOutputStream()
        pq.write_table(joined, sink, compression="zstd", row_group_size=_ROWS_PER_GROUP)
        _write_whole(self._out, bytes(sink.getvalue()))
        shutil.rmtree(self.folder, ignore_errors=True)
        return self._out

    def _file(self, piece: Piece) -> Path:
        name = hashlib.sha256(f"{self._identity}/{piece[0]}/{piece[1]}".encode()).hexdigest()
        return self.folder / f"{name}.arrow"

    def _read(self, piece: Piece) -> pyarrow.Table | None:
        import pyarrow as pa

        file = self._file(piece)
        try:
            table = pa.ipc.open_file(pa.py_buffer(file.read_bytes())).read_all()
        except (OSError, pa.ArrowInvalid):
            return None
        return table if table.num_rows == piece[1] - piece[0] else None


def _write_whole(file: Path, data: bytes) -> None:
    """Write a file so that it is there whole or not at all, also after a power failure."""
    file.parent.mkdir(parents=True, exist_ok=True)
    partial = file.with_name(f"{file.name}.{os.getpid()}.partial")
    with partial.open("wb") as stream:
        stream.write(data)
        stream.flush()
        os.fsync(stream.fileno())
    partial.replace(file)
