"""Look-up tables of the spectral mixer: head spectra by direction, and interaural delays.

Each response is split into a minimum-phase part, which can be interpolated between directions without comb filtering,
and a pure interaural delay. The delay is fitted so that the pair has the original's below 1.5 kHz, where hearing uses
it, and is interpolated as a number: exact to a fraction of a sample and continuous. Directions lie on a grid of one
degree, whose cells are computed on first use.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.audio.spectral.bins import ROWS
from mimics_app.rendering.audio.spectral.cell_kernels import Cells, add_blended
from mimics_app.rendering.audio.spectral.fourier import BINS, SIZE, turns_of
from mimics_app.rendering.audio.spectral.head import LOW_PASS, HeadResponses, delays_between_ears
from mimics_app.rendering.audio.spectral.lanes import WIDTH, aligned, aligned_zeros
from mimics_app.rendering.audio.spectral.mix_kernels import Tables

__all__ = ["BASE_DELAY", "DELAYS_PER_SAMPLE", "HeadTable", "build_head_table", "half_delay_rows"]


BASE_DELAY = 40
"""Delay of the centre of the head [samples]: the nearer ear precedes it by half of the interaural delay, at most
0.5 ms, and a fractional delay has some pre-ringing."""

DELAYS_PER_SAMPLE = 32
"""Rows of the table of delays per sample of half the delay: steps of 1.3 us between the ears."""

TAPS = 200
"""Length of the minimum-phase part; with delays and shelves it must fit into SIZE - BLOCK + 1 = 273 samples."""

_DRY, _FIRST_CELL = 0, 3
"""Cells 0 to 2: unfiltered in both ears, in the left, in the right ear; then the directions."""

_DELAY_STEPS = 91  # rows of the delay grid, every 2 degrees of elevation; columns every 2 degrees of azimuth
_EDGE = 0.75  # of the Nyquist frequency: 18 kHz at 48 kHz
_FADE = 40  # longest fade-out of a response [samples]
_QUIETEST = 1e-4  # floor of a magnitude spectrum relative to its maximum: -80 dB
_LEVEL_BAND = (300.0, 6000.0)  # band in which the mean level over directions is normalised [Hz]
_LOWER_EDGE, _UPPER_EDGE = 500.0, 4000.0  # corner frequencies of the shelves between the three bands [Hz]


@dataclass(frozen=True, slots=True, eq=False)
class HeadTable:
    """Tables of a head.

    Attributes:
        tables: Tables of the mixing kernels.
        cells: Responses by direction, computed on first use.
        delays: Half the delay of the left ear behind the right on a grid over elevation and azimuth [samples],
            shape [91, 181]: every 2 degrees, azimuth from -180 to 180.
        name: Name of the head.
    """

    tables: Tables
    cells: Cells
    delays: F8
    name: str


def build_head_table(head: HeadResponses, rate: int, taps: int = TAPS) -> HeadTable:
    """Compute the tables.

    Args:
        head: Responses at any rate.
        rate: Samples per second of the mix.
        taps: Length of the minimum-phase part, at most TAPS; the cost of mixing does not depend on it.
    """
    pulses = _minimum_phase(head, rate, taps)
    delays = delays_between_ears(head.responses, head.rate)
    lead = np.exp(-2j * np.pi * np.arange(BINS) * BASE_DELAY / SIZE) * _edge()
    spectra = np.fft.rfft(pulses, SIZE)[..., :BINS] * lead
    rows = np.concatenate(([_FIRST_CELL], _FIRST_CELL + np.cumsum([_columns(degree) for degree in range(181)])))
    cells = aligned_zeros(int(rows[-1]), 4 * BINS)
    for cell, ears in enumerate(((1.0, 1.0), (1.0, 0.0), (0.0, 1.0))):
        cells[cell] = _flat(lead * np.array(ears)[:, None])
    filled = np.zeros(len(cells), np.int64)
    filled[:_FIRST_CELL] = 1
    frequency = np.arange(BINS) * rate / SIZE
    low = Cells(
        filled=filled,
        rows=rows.astype(np.int64),
        directions=head.directions,
        measured=np.stack([_flat(pair) for pair in spectra]),
        spectra=cells.reshape(-1),
        halves=np.zeros(len(cells)),
        weights=1.0 / (1.0 + (frequency / LOW_PASS) ** 8),
    )
    tables = Tables(low.spectra, _delay_rows(rate), _shelf_rows(rate), turns_of())
    return HeadTable(tables, low, _delay_grid(head.directions, 0.5 * rate * delays), head.name)


def _edge() -> F8:
    """Return a fade over the last quarter of the spectrum: a fractional delay would ring at the Nyquist frequency."""
    share = np.clip((np.arange(BINS) / BINS - _EDGE) / (1.0 - _EDGE), 0.0, 1.0)
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * share))


def _columns(degree: int) -> int:
    """Return the number of cells in a row of the grid, at most one degree apart."""
    return max(1, int(np.ceil(360.0 * np.cos(np.radians(degree - 90.0)) - 1e-9)))


def _flat(pair: NDArray[np.complex128]) -> NDArray[np.float32]:
    """Return a cell, shape [4 * BINS], of the spectra of both ears, shape [2, BINS], interleaved by rows of bins."""
    parts = np.stack((pair.real, pair.imag), axis=1).reshape(4, ROWS, WIDTH)
    return parts.transpose(1, 0, 2).astype(np.float32).reshape(-1)


def _minimum_phase(head: HeadResponses, rate: int, taps: int) -> F8:
    """Return the minimum-phase responses at `rate`, shape [n, 2, taps], normalised to a level of 1."""
    size = 2048
    own = np.fft.rfftfreq(2 * size, 1.0 / head.rate)
    frequency = np.fft.rfftfreq(size, 1.0 / rate)
    window = np.ones(taps)
    fade = min(_FADE, taps // 2)
    window[-fade:] = 0.5 + 0.5 * np.cos(np.pi * (np.arange(fade) + 1.0) / fade)
    fold = np.zeros(size)
    fold[[0, size // 2]], fold[1 : size // 2] = 1.0, 2.0
    pulses = np.empty((*head.responses.shape[:2], taps))
    for n, pair in enumerate(head.responses):
        magnitude = np.abs(np.fft.rfft(pair, 2 * size))
        magnitude = np.maximum(magnitude, _QUIETEST * magnitude.max())
        log = np.stack([np.interp(frequency, own, np.log(ear)) for ear in magnitude])
        pulses[n] = np.fft.irfft(np.exp(np.fft.rfft(np.fft.irfft(log, size) * fold)), size)[:, :taps] * window
    power = np.abs(np.fft.rfft(pulses, 512)) ** 2
    band = np.fft.rfftfreq(512, 1.0 / rate)
    inside = (band >= _LEVEL_BAND[0]) & (band <= _LEVEL_BAND[1])
    return np.asarray(pulses / np.sqrt(power[:, :, inside].mean()))


def _delay_rows(rate: int) -> NDArray[np.float32]:
    """Return all half delays in the layout of `bins.DELAY_ROW`, [rows * DELAY_ROW]."""
    most = half_delay_rows(rate)
    samples = np.arange(-most, most + 1) / DELAYS_PER_SAMPLE
    first, rows = np.arange(WIDTH), WIDTH * np.arange(ROWS)
    angle = -2.0 * np.pi * samples[:, None, None] * np.stack((first, rows)) / SIZE
    return aligned(np.stack((np.cos(angle), np.sin(angle)), axis=2))


def half_delay_rows(rate: int) -> int:
    """Return the rows of the table of delays on each side of zero: up to 0.5 ms, limited by the base delay."""
    return int(min(0.5e-3 * rate, BASE_DELAY - 16) * DELAYS_PER_SAMPLE)


def _shelf_rows(rate: int) -> NDArray[np.float32]:
    """Return the factor of s in the first-order shelf 1 + s i u / (1 + i u), u = f / edge, [4 * BINS]."""
    u = np.arange(BINS) * rate / SIZE / np.array([[_LOWER_EDGE], [_UPPER_EDGE]])
    return aligned(np.stack((u * u / (1.0 + u * u), u / (1.0 + u * u)), axis=1))


def _delay_grid(directions: F8, delays: F8) -> F8:
    """Interpolate the delays of some directions smoothly to the grid of `HeadTable.delays`.

    Polynomials on the sphere (at most one coefficient per eight directions, up to degree 8) fit the smooth part; the
    residual is interpolated from the nearest directions, so that the result is exact at each of them.
    """
    degree = int(np.clip(np.sqrt(len(directions) / 8.0) - 1.0, 1.0, 8.0))
    basis = _polynomials(directions, degree)
    weights = np.linalg.lstsq(basis, delays, rcond=1e-9)[0]
    rest = delays - basis @ weights
    elevation = np.radians(np.arange(_DELAY_STEPS) * 2.0 - 90.0)
    azimuth = np.radians(np.arange(2 * _DELAY_STEPS - 1) * 2.0 - 180.0)
    level = np.cos(elevation)[:, None]
    up = np.broadcast_to(np.sin(elevation)[:, None], (len(elevation), len(azimuth)))
    points = np.stack((level * np.sin(azimuth), up, -level * np.cos(azimuth)), axis=-1).reshape(-1, 3)
    field = _polynomials(points, degree) @ weights
    add_blended(points, directions, rest, field)
    return field.reshape(len(elevation), len(azimuth))


def _polynomials(points: F8, degree: int) -> F8:
    """Return all x^i y^j z^k with i + j + k up to a degree and k at most 1: a basis of polynomials on the sphere."""
    x, y, z = points.T
    return np.stack(
        [x**i * y**j * z**k for k in (0, 1) for i in range(degree + 1 - k) for j in range(degree + 1 - k - i)],
        axis=-1,
    )
