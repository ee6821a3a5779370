"""Principal axes of a body: what (12) turns by, found once when the body is made or its mass changes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import Mat
from mimics_app.contracts.kernel import kernel
from mimics_app.maths import quat
from mimics_app.rendering.haptic.kernels.eigen import diagonalise

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import DynamicsRecord

__all__ = ["find_principal_axes"]


_NOTHING = 1e-9
"""Share of the greatest moment below which a moment is rounding: a steel wire has 1e-6."""


@kernel
def find_principal_axes(inertia: Mat, dynamics: DynamicsRecord) -> None:
    """Set `axes` and `inverse` of a body from its inertia (Jacobi 1846), and remember the inertia.

    A tensor that is diagonal already keeps its axes to the last bit. Moments that are nothing beside the greatest (a
    thin rod about itself) belong to axes the body does not turn about.

    Args:
        inertia: About the centre of mass, body axes [kg m^2], shape [3, 3], symmetric.
        dynamics: Record of `DYNAMICS`, updated.
    """
    tensor, vectors = dynamics.tensor, dynamics.vectors
    for i in range(3):
        for j in range(3):
            dynamics.inertia[i, j] = inertia[i, j]
            tensor[i, j] = 0.5 * (inertia[i, j] + inertia[j, i])
    diagonalise(tensor, vectors)
    quat.from_matrix(vectors, dynamics.axes)
    least = _NOTHING * max(tensor[0, 0], max(tensor[1, 1], tensor[2, 2]))
    for i in range(3):
        dynamics.inverse[i] = 1.0 / tensor[i, i] if tensor[i, i] > least else 0.0
