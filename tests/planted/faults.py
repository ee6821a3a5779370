"""The list of planted faults: one line of the product changed each, and the test that has to turn red."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

__all__ = ["LISTS", "ROOT", "PlantedFault", "read_faults"]

ROOT = Path(__file__).parents[2]
LISTS = Path(__file__).parent
"""Folder of the lists: a TOML file a room, with a table `[[fault]]` each."""


@dataclass(frozen=True)
class PlantedFault:
    """A change of the product that a test has to notice.

    `line` stands exactly once in `file`; `planted` takes its place. `test` is a node id of pytest.
    """

    room: str
    name: str
    file: str
    line: str
    planted: str
    test: str

    def plant(self, source: str) -> str:
        """Return `source` with the fault; ValueError where the line stands in it not exactly once."""
        if (found := source.count(self.line)) != 1:
            raise ValueError(f"{self.file}: {self.line!r} stands {found} times, expected once ({self.name})")
        return source.replace(self.line, self.planted)


def read_faults(folder: Path = LISTS) -> Iterator[PlantedFault]:
    """Yield the faults of every list, in the order of the files' names."""
    for path in sorted(folder.glob("*.toml")):
        for row in tomllib.loads(path.read_text(encoding="utf-8"))["fault"]:
            yield PlantedFault(room=path.stem, **row)
