"""Principal axes and moments of a body for (12), found when the body is new or its inertia changes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat
from mimics_app.maths import quat
from mimics_app.rendering.haptic.kernels.eigen import diagonalise

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import DynamicsRecord

__all__ = ["find_principal_axes"]


_ROUNDING = 1e-9
"""Ratio to the largest moment below which a moment counts as 0 [-]: a steel wire has 1e-6."""


@kernel
def find_principal_axes(inertia: Mat, dynamics: DynamicsRecord) -> None:
    """Set `axes` and `inverse` of a body from its inertia (Jacobi 1846), and keep the inertia.

    A diagonal tensor keeps its axes to the last bit. Axes of negligible moment (a thin rod about itself) are locked.

    Args:
        inertia: Tensor about the centre of mass, body axes [kg m^2], shape [3, 3], symmetric.
        dynamics: Record of `DYNAMICS`, updated.
    """
    tensor, vectors = dynamics.tensor, dynamics.vectors
    for i in range(3):
        for j in range(3):
            dynamics.inertia[i, j] = inertia[i, j]
            tensor[i, j] = 0.5 * (inertia[i, j] + inertia[j, i])
    diagonalise(tensor, vectors)
    quat.from_matrix(vectors, dynamics.axes)
    least = _ROUNDING * max(tensor[0, 0], max(tensor[1, 1], tensor[2, 2]))
    for i in range(3):
        dynamics.inverse[i] = 1.0 / tensor[i, i] if tensor[i, i] > least else 0.0
