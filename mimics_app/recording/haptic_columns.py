"""Columns of the haptic stream of a run, each read when it is asked for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.recording.arrow_format import BLOCK_ROWS, decode_samples, schema_bytes
from mimics_app.recording.arrow_scan import FoundBlock, read_index, scan_stream
from mimics_app.recording.column_file import read_columns
from mimics_app.recording.columns import present_columns, rows_of
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import FILES

__all__ = ["HapticColumns"]


class HapticColumns:
    """The valid rows of haptic.arrows, from haptic_columns.arrows as far as that goes.

    Where haptic.arrows misses blocks or is of an earlier version, it is read as a whole; blocks whose rows are in the
    columns are not verified again. All columns have the rows that there were when the first was read: a row that is
    damaged in both files is NaN in the columns that lost it, so that a row is the same tick in every column.

    Args:
        run: The run.
    """

    def __init__(self, run: Run) -> None:
        self._run = run
        self._rows: int | None = None
        self._rest: dict[int, F8] = {}

    def read(self, chosen: Sequence[int]) -> F8:
        """Return recorded columns.

        Args:
            chosen: Their indices in the order of the recording, ascending.

        Returns:
            Their values, shape [rows, len(chosen)].
        """
        extent, blocks = self._run.layout.extent, 0
        parts: list[list[NDArray[np.float64]]] = []
        for batch in read_columns(self._run.folder, extent, chosen) if len(self._index) else ():
            if batch.blocks > len(self._index):
                break
            parts.append(batch.values)
            blocks = batch.blocks
        rest = self._after(blocks, sum(len(part[0]) for part in parts))[:, list(chosen)]
        parts.append(list(rest.T))
        rows = sum(len(part[0]) for part in parts)
        self._rows = rows if self._rows is None else self._rows
        found = np.full((max(rows, self._rows), len(chosen)), np.nan)
        row = 0
        for part in parts:
            for i, values in enumerate(part):
                found[row : row + len(values), i] = values
            row += len(part[0])
        return found[: self._rows]

    @cached_property
    def _index(self) -> NDArray[np.void]:
        """The sidecar of a haptic.arrows that has every block of the session in order, beside columns; else empty."""
        path, layout = self._run.folder / FILES["haptic"], self._run.layout
        index = read_index(path.with_name(FILES["index"]))
        ends = np.concatenate(([len(schema_bytes(layout.schema))], index["offset"] + index["length"]))
        whole = (
            layout.current
            and path.is_file()
            and path.with_name(FILES["columns"]).is_file()
            and np.array_equal(index["seq"], np.arange(len(index)))
            and np.array_equal(index["offset"], ends[:-1])
            and ends[-1] <= path.stat().st_size
        )
        return index if whole else index[:0]

    def _after(self, blocks: int, rows: int) -> F8:
        """Return the rows after so many blocks, which hold `rows` rows, shape [rows, recorded columns]."""
        if blocks not in self._rest:
            run, chosen = self._run, present_columns(self._run.layout.extent)
            found = self._scan(blocks, rows) if len(self._index) else (run.haptic,)
            parts = [rows_of(each)[:, chosen] if each.dtype.names else each for each in found]
            self._rest[blocks] = np.concatenate([np.empty((0, len(chosen))), *parts])
        return self._rest[blocks]

    def _scan(self, blocks: int, rows: int) -> Iterator[NDArray[Any]]:
        """Yield the samples of the blocks from a number on, and rows of NaN for damaged ones."""
        run, layout, index = self._run, self._run.layout, self._index
        begin = index["offset"][blocks] if blocks < len(index) else index["offset"][-1] + index["length"][-1]
        path, width = run.folder / FILES["haptic"], len(present_columns(layout.extent))
        for piece in scan_stream(
            path, lambda data: decode_samples(data, layout), layout.schema, index[blocks:], int(begin)
        ):
            if not isinstance(piece, FoundBlock):
                continue
            block = piece.block
            if block.seq > blocks:
                lost = min(max(0, block.first - rows), (block.seq - blocks) * BLOCK_ROWS)
                yield np.full((lost, width), np.nan)
            yield block.records
            blocks, rows = block.seq + 1, block.first + len(block.records)
