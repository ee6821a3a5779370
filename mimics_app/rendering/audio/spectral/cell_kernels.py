"""Cells of the direction grid, interpolated from the nearest measured directions on first use."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, F8, Words
from mimics_app.rendering.audio.spectral.fourier import BINS
from mimics_app.rendering.audio.spectral.lanes import WIDTH

__all__ = ["Cells", "add_blended", "cell_of", "fill_cell"]


NEIGHBOURS = 4
"""Number of measured directions that a cell is interpolated from."""

_LOW_BINS = 33  # of SIZE: up to 3 kHz at 48 kHz, where the weight has fallen to 1/256
_REACH = 36  # samples on each side of the coarse search for the peak
_COARSE = 3  # step of the coarse search [samples]: a tenth of the period of 1.5 kHz
_STEPS = 6  # iterations of Newton's method

_LOWEST = 90
"""Depression of the first row of the grid [degrees]."""

_PARTS = 4
"""Parts of a cell: left and right, real and imaginary."""

_MET = 1e-10
"""Squared angle below which a measured direction is used alone [rad^2]."""


class Cells(NamedTuple):
    """Head responses by direction.

    Attributes:
        filled: 1 for each cell that is interpolated, shape [cells].
        rows: First cell of each degree of elevation, then the number of cells, shape [182].
        directions: Measured directions, unit vectors, shape [n, 3].
        measured: Spectra of the measured directions, shape [n, 4 * BINS].
        spectra: Spectra of the cells, see `Tables.cells`.
        halves: Half of the interaural delay inherent in the spectra, left behind right [samples], shape [cells].
        weights: Weights of the low bins used to estimate that delay, shape [_LOW_BINS].
    """

    filled: Words
    rows: Words
    directions: F8
    measured: F4
    spectra: F4
    halves: F8
    weights: F8


@kernel
def _find_nearest(point: F8, directions: F8, index: Words, weight: F8) -> None:
    """Find the nearest directions and their inverse-square weights; a direction that coincides has all the weight."""
    weight[:] = np.inf
    for n in range(directions.shape[0]):
        gap = 0.0
        for axis in range(3):
            gap += (point[axis] - directions[n, axis]) ** 2
        place = index.shape[0]
        while place > 0 and gap < weight[place - 1]:
            place -= 1
        if place < index.shape[0]:
            for k in range(index.shape[0] - 1, place, -1):
                weight[k], index[k] = weight[k - 1], index[k - 1]
            weight[place], index[place] = gap, n
    if weight[0] < _MET:
        weight[:] = 0.0
        weight[0] = 1.0
        return
    total = 0.0
    for k in range(weight.shape[0]):
        weight[k] = 1.0 / weight[k]
        total += weight[k]
    weight[:] = weight / total


@kernel
def add_blended(points: F8, directions: F8, values: F8, field: F8) -> None:
    """Add to `field`, shape [m], the values interpolated from the directions nearest to each point."""
    index, weight = np.zeros(NEIGHBOURS, np.int64), np.zeros(NEIGHBOURS)
    for m in range(points.shape[0]):
        _find_nearest(points[m], directions, index, weight)
        for k in range(NEIGHBOURS):
            field[m] += weight[k] * values[index[k]]


@kernel
def cell_of(azimuth: float, elevation: float, rows: Words) -> int:
    """Return the cell nearest to a direction; azimuth clockwise from ahead, elevation upwards [rad]."""
    degree = int(np.rint(np.degrees(elevation))) + _LOWEST
    count = rows[degree + 1] - rows[degree]
    return rows[degree] + int(np.rint((azimuth + np.pi) / (2.0 * np.pi) * count)) % count


@kernel
def fill_cell(cell: int, azimuth: float, elevation: float, cells: Cells) -> None:
    """Interpolate the response of a cell at its centre, where that is not done yet."""
    if cells.filled[cell] != 0:
        return
    degree = int(np.rint(np.degrees(elevation)))
    count = cells.rows[degree + _LOWEST + 1] - cells.rows[degree + _LOWEST]
    middle = np.rint((azimuth + np.pi) / (2.0 * np.pi) * count) / count * 2.0 * np.pi - np.pi
    up = np.radians(float(degree))
    index, weight, point = np.zeros(NEIGHBOURS, np.int64), np.zeros(NEIGHBOURS), np.zeros(3)
    point[0], point[1], point[2] = np.cos(up) * np.sin(middle), np.sin(up), -np.cos(up) * np.cos(middle)
    _find_nearest(point, cells.directions, index, weight)
    width = _PARTS * BINS
    spectra = cells.spectra[cell * width : (cell + 1) * width]
    for i in range(width):
        total = np.float32(0.0)
        for k in range(NEIGHBOURS):
            total += np.float32(weight[k]) * cells.measured[index[k], i]
        spectra[i] = total
    cells.halves[cell] = 0.5 * _own_delay(spectra, cells.weights)
    cells.filled[cell] = 1


@kernel
def _own_delay(spectra: F4, weights: F8) -> float:
    """Return the delay of the left ear behind the right [samples]: the peak of the low bins' cross-correlation."""
    delay, most = 0.0, -np.inf
    for whole in range(-_REACH, _REACH + 1, _COARSE):
        height = _correlation(spectra, weights, float(whole))[0]
        if height > most:
            delay, most = float(whole), height
    for _ in range(_STEPS):
        _, slope, bend = _correlation(spectra, weights, delay)
        if bend < 0.0:
            delay -= slope / bend
    return delay


@kernel
def _correlation(spectra: F4, weights: F8, delay: float) -> tuple[float, float, float]:
    """Return the cross-correlation of the ears at a delay [samples], and its first two derivatives."""
    step = np.pi / BINS
    height, slope, bend = 0.0, 0.0, 0.0
    for k in range(1, _LOW_BINS):
        at = k // WIDTH * _PARTS * WIDTH + k % WIDTH
        a, b, c, d = spectra[at], spectra[at + WIDTH], spectra[at + 2 * WIDTH], spectra[at + 3 * WIDTH]
        re, im = a * c + b * d, b * c - a * d  # left times conjugate of right
        u, w = np.cos(step * k * delay), np.sin(step * k * delay)
        height += weights[k] * (re * u - im * w)
        slope -= weights[k] * step * k * (re * w + im * u)
        bend -= weights[k] * (step * k) ** 2 * (re * u - im * w)
    return height, slope, bend
