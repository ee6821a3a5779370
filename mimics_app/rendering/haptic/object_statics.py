"""What the objects' part of the tick is given once: triangles, paths, force fields; for a session and its replay."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.haptic_objects import TUNNEL
from mimics_app.contracts.object_rows import ObjectCapacities
from mimics_app.rendering.haptic.force_fields import find_field
from mimics_app.rendering.haptic.kernels.objects.records import MESH
from mimics_app.rendering.haptic.mesh_table import MeshTable, build_mesh_table
from mimics_app.rendering.haptic.no_objects import NO_FIELDS
from mimics_app.rendering.haptic.objects import ObjectWork, new_object_work

__all__ = ["ObjectStatics"]

_PATHS = "paths"


@dataclass(frozen=True, eq=False)
class ObjectStatics:
    """Never changed while the loop runs.

    Attributes:
        meshes: Triangles by SHAPE.mesh.
        paths: TUNNEL records by EFFECT.path, shape [n].
        fields: Names of the force fields by EFFECT.field.
    """

    meshes: MeshTable
    paths: NDArray[Any]
    fields: Sequence[str]

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[Any]], fields: Sequence[str]) -> ObjectStatics:
        """From what `arrays` gave.

        Raises:
            ValueError: A table is missing, or of another form.
        """
        known = {name: arrays[name] for name in MeshTable._fields if name in arrays}
        if known and len(known) < len(MeshTable._fields):
            raise ValueError("a table of the meshes is missing")
        meshes = MeshTable(**{**known, "rows": _as_in_memory(known["rows"])}) if known else build_mesh_table()
        return cls(meshes, arrays.get(_PATHS, np.zeros(0, TUNNEL)), fields)

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """The tables in use by name."""
        found: dict[str, NDArray[Any]] = self.meshes._asdict() if len(self.meshes.rows) else {}
        return {**found, _PATHS: self.paths} if len(self.paths) else found

    def work(self, capacities: ObjectCapacities) -> ObjectWork:
        """Fresh working arrays that hold them; `capacities.paths` must be enough."""
        work = new_object_work(capacities, self.meshes)
        work.paths[: len(self.paths)] = self.paths
        return work

    def functions(self) -> tuple[Callable[..., Any], ...]:
        """The compiled force fields, MAX_FIELDS of them.

        Raises:
            UsageError: One of that name is not installed, or its plug-in cannot be used.
        """
        return (*(_installed(name) for name in self.fields), *NO_FIELDS[len(self.fields) :])


def _as_in_memory(stored: NDArray[Any]) -> NDArray[Any]:
    """MESH records as the compiled loop takes them: a file does not keep that a record is aligned."""
    if stored.dtype != MESH:
        raise ValueError("the rows of the meshes are of another form")
    rows = np.zeros(stored.shape, MESH)
    rows[:] = stored
    return rows


def _installed(name: str) -> Callable[..., Any]:
    """The force field of that name; a recording may name one that was there on another day."""
    try:
        found: Callable[..., Any] = find_field(name)
    except (KeyError, ValueError) as error:
        raise UsageError(str(error.args[0]), "install what it was recorded with") from error
    return found
