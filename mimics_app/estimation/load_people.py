"""Labelled trials of many people, on which the discriminants are trained and tested."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.resources import root

__all__ = ["LoadPeople", "shipped_people"]


@dataclass(frozen=True, slots=True)
class LoadPeople:
    """Labelled trials.

    Attributes:
        family: Number of each person's family, shape [p].
        features: Features of each trial, see `trial_view.FEATURES`, shape [p, t, f].
        classes: True class of each trial, shape [p, t].
        fusion: Probabilities of the classes by the Kalman fusion, mean of the last half minute, [p, t, 3].
    """

    family: NDArray[np.int64]
    features: F8
    classes: NDArray[np.int64]
    fusion: F8

    def write(self, path: Path, what: str) -> None:
        """Write a JSON file.

        Args:
            path: Name of the file.
            what: Description of the people.

        Raises:
            OSError: It cannot be written.
        """
        lines = [f' "what": {json.dumps(what)}', f' "family": {json.dumps(self.family.tolist())}']
        for name in ("features", "classes", "fusion"):
            rows = [json.dumps(np.round(row, 3).tolist()) for row in getattr(self, name)]
            lines.append(f' "{name}": [\n  ' + ",\n  ".join(rows) + "\n ]")
        path.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")

    @staticmethod
    def read(path: Path) -> LoadPeople:
        """Read a file that `write` wrote.

        Raises:
            SceneError: The file is missing, or holds no trials.
        """
        try:
            data = json.loads(path.read_text(encoding="utf-8"))
            family, classes = (np.array(data[name], np.int64) for name in ("family", "classes"))
            return LoadPeople(family, np.array(data["features"], float), classes, np.array(data["fusion"], float))
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise SceneError(
                Issue(str(path), "", f"it holds no trials: {error}", "install the program again")
            ) from error


@cache
def shipped_people() -> LoadPeople:
    """Return the trials of the simulated people shipped with the product."""
    return LoadPeople.read(root() / "assets" / "load_people.json")
