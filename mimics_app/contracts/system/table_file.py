"""Tables of content: JSON files beside the modules that build with them."""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

import msgspec

__all__ = ["read_table_file"]

T = TypeVar("T")


def read_table_file(file: Path, kind: type[T]) -> T:
    """Return the content of a table.

    Args:
        file: JSON file.
        kind: Its type: lists, dictionaries and dataclasses.

    Raises:
        msgspec.ValidationError: the file holds something else.
    """
    return msgspec.json.decode(file.read_bytes(), type=kind)
