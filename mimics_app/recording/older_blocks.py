"""Parameter blocks of versions in which the one tunnel was part of every block, read as blocks with rows."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import SCENE
from mimics_app.contracts.haptic_objects import OBJECT_COUNTS
from mimics_app.contracts.object_rows import ROW_DTYPES, Rows, count_rows

__all__ = ["current_block", "rows_with_tunnel"]

Records = NDArray[Any]

_TUNNEL = "tunnel"
"""The field that held it."""

_NEW = {"own_tunnel", "objects"}
"""Fields of SCENE that such a block lacks, or that count one table less."""


def rows_with_tunnel(record: Records, rows: Rows | None) -> Rows | None:
    """The tables beside a block, with the tunnel that an older version wrote into the block itself.

    Args:
        record: Shape [1], with the dtype of the version that wrote it.
        rows: The tables beside it, None where that version had none.

    Returns:
        `rows` of a block without such a field; its row of tunnels keeps that version's dtype.
    """
    names = record.dtype.names or ()
    if _TUNNEL not in names or "pieces" not in (record.dtype[_TUNNEL].names or ()):
        return rows
    others = rows or Rows(*(np.zeros(0, dtype) for dtype in ROW_DTYPES.values()))
    return others._replace(tunnels=record[_TUNNEL][record[_TUNNEL]["pieces"] > 0].copy())


def current_block(record: Records, rows: Rows | None) -> Records | None:
    """A block as this version's SCENE record, shape [1]; None where it says something else, or not all of it.

    Args:
        record: Shape [1], with the dtype of the version that wrote it.
        rows: From `rows_with_tunnel`.
    """
    if record.dtype == SCENE:
        return record
    old = set(record.dtype.names or ())
    kept = [name for name in SCENE.names or () if name not in _NEW]
    same = old - {_TUNNEL, *_NEW} == set(kept) and all(record.dtype[name] == SCENE[name] for name in kept)
    if not same or rows is None or any(table.dtype != ROW_DTYPES[name] for name, table in rows._asdict().items()):
        return None
    block = np.zeros(1, SCENE)
    for name in kept:
        block[name] = record[name]
    if "objects" in old:
        counts = record["objects"][0]
        for name in set(counts.dtype.names or ()) & {*(OBJECT_COUNTS.names or ())}:
            block["objects"][name] = counts[name]
    block["objects"]["tunnels"] = len(rows.tunnels)
    return block if count_rows(block[0]["objects"]) == {name: len(t) for name, t in rows._asdict().items()} else None
