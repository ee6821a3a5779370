"""Methods of lens distortion, per pixel or by a mesh, for a panel of 1080 pixels and the default lens.

Error: the largest displacement on the panel; cost: of the texture coordinates of one eye, on the
processor.
"""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.rendering.visual.displays.headset_file import HeadsetSpec
from mimics_app.rendering.visual.displays.lens import distort

__all__: list[str] = []


_PIXELS = 1080
_COUNT = 541
"""Points along a side at which a mesh is compared."""


def _grid(count: int) -> F8:
    left, right, bottom, top = HeadsetSpec().left.tangents
    x, y = np.meshgrid(np.linspace(left, right, count), np.linspace(bottom, top, count))
    return np.stack([x, y], axis=-1)


def _mesh_error(cells: int) -> float:
    """Return the largest error of a mesh of cells by cells, linear between its vertices [px of 1080]."""
    eye = HeadsetSpec().left
    k = eye.lens.green
    corners, exact = distort(_grid(cells + 1), k), distort(_grid(_COUNT), k)
    at = np.linspace(0.0, cells, _COUNT)
    i = np.minimum(at.astype(int), cells - 1)
    f = at - i
    rows = corners[i] * (1.0 - f)[:, None, None] + corners[i + 1] * f[:, None, None]
    both = rows[:, i] * (1.0 - f)[None, :, None] + rows[:, i + 1] * f[None, :, None]
    off = np.linalg.norm(both - exact, axis=-1)
    # From directions to positions on the panel by the slope of the lens there, and to pixels.
    r2 = np.sum(_grid(_COUNT) ** 2, axis=-1)
    slope = 1.0 + k[0] * r2 + k[1] * r2 * r2
    return float((off / slope).max() * _PIXELS / (eye.tangents[1] - eye.tangents[0]))


def _cost(count: int) -> float:
    at = _grid(count)
    lens = HeadsetSpec().left.lens
    return shortest_us(lambda: [distort(at, k) for k in (lens.red, lens.green, lens.blue)])


compare(
    __name__,
    "where a panel of 1080 pixels looks up an eye's picture, for three colours; error: on the panel",
    "px",
    [
        Rival(
            "per pixel",
            "the polynomial of Brown (1971) in the fragment shader",
            "any lens whose radius grows throughout",
            {},
            cost=lambda: _cost(_PIXELS),
            error=lambda: 0.0,
        ),
        *(
            Rival(
                f"mesh of {cells} x {cells}",
                "corners looked up exactly, linear between them",
                "where its error does",
                probed=(cells,),
            )
            for cells in (16, 32, 64, 128)
        ),
    ],
    Probes(lambda cells: _cost(cells + 1), _mesh_error),
    default="per pixel",
)
