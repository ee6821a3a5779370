"""Constant data of the haptic objects: triangle meshes, paths and force fields, for a session and its replay."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.haptic_objects import TUNNEL
from mimics_app.contracts.loop.object_rows import ObjectCapacities
from mimics_app.rendering.haptic.force_fields import find_field
from mimics_app.rendering.haptic.kernels.objects.records import MESH
from mimics_app.rendering.haptic.mesh_table import MeshTable, build_mesh_table
from mimics_app.rendering.haptic.no_objects import NO_FIELDS
from mimics_app.rendering.haptic.objects import ObjectWork, new_object_work

__all__ = ["ObjectStatics"]

_PATHS = "paths"


@dataclass(frozen=True, eq=False)
class ObjectStatics:
    """Data of the objects that do not change while the loop runs.

    Attributes:
        meshes: Triangle meshes by SHAPE.mesh.
        paths: TUNNEL records by EFFECT.path, shape [n].
        fields: Names of the force fields by EFFECT.field.
    """

    meshes: MeshTable
    paths: NDArray[Any]
    fields: Sequence[str]

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[Any]], fields: Sequence[str]) -> ObjectStatics:
        """Rebuild the statics from their `arrays`.

        Raises:
            ValueError: A table is missing, or has another dtype.
        """
        known = {name: arrays[name] for name in MeshTable._fields if name in arrays}
        if known and len(known) < len(MeshTable._fields):
            raise ValueError("a table of the meshes is missing")
        meshes = MeshTable(**{**known, "rows": _as_in_memory(known["rows"])}) if known else build_mesh_table()
        return cls(meshes, arrays.get(_PATHS, np.zeros(0, TUNNEL)), fields)

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """Tables in use, by name."""
        found: dict[str, NDArray[Any]] = self.meshes._asdict() if len(self.meshes.rows) else {}
        return {**found, _PATHS: self.paths} if len(self.paths) else found

    def work(self, capacities: ObjectCapacities) -> ObjectWork:
        """Return fresh working arrays with these statics; `capacities.paths` must be large enough."""
        work = new_object_work(capacities, self.meshes)
        work.paths[: len(self.paths)] = self.paths
        return work

    def functions(self) -> tuple[Callable[..., Any], ...]:
        """Return the compiled force fields, padded to MAX_FIELDS.

        Raises:
            UsageError: A force field is not installed, or its plug-in cannot be used.
        """
        return (*(_installed(name) for name in self.fields), *NO_FIELDS[len(self.fields) :])


def _as_in_memory(stored: NDArray[Any]) -> NDArray[Any]:
    """Return MESH records with the aligned dtype of the loop, which a file does not preserve."""
    if stored.dtype != MESH:
        raise ValueError("the rows of the meshes have another dtype")
    rows = np.zeros(stored.shape, MESH)
    rows[:] = stored
    return rows


def _installed(name: str) -> Callable[..., Any]:
    """Return the force field of this name; a recording may name one that is not installed."""
    try:
        found: Callable[..., Any] = find_field(name)
    except (KeyError, ValueError) as error:
        raise UsageError(str(error.args[0]), "install the plug-in that it was recorded with") from error
    return found
