"""From measured or computed responses to what the mixer looks up: spectra by direction, and delays between the ears.

Each response is split into a minimum-phase part, which can be blended between neighbouring directions without a comb,
and a pure delay between the ears. The delay is fitted so that the pair has the original's below 1.5 kHz, where the ear
uses it; that one is blended as a number, so it is exact to a fraction of a sample and free of jumps. Directions lie on
a grid of one degree that is filled where sounds come from.
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

__all__ = ["BASE_DELAY", "DELAYS_PER_SAMPLE", "DRY", "FIRST_CELL", "HeadTable", "build_head_table", "half_delay_rows"]


BASE_DELAY = 40
"""Samples by which the middle of the head hears later than the sound starts: the nearer ear is before that by half of
the delay between them, at most 0.5 ms, and a delay of parts of a sample rings a little ahead."""

DELAYS_PER_SAMPLE = 32
"""Rows of the table of delays per sample of half the delay: 1.3 us between the ears."""

TAPS = 200
"""Of the minimum-phase part. With the delays and the shapes of the path it must fit into what a block leaves, 273."""

DRY, FIRST_CELL = 0, 3
"""Cells 0 to 2: as it is in both ears, left ear alone, right ear alone; then the directions."""

_DELAY_STEPS = 91  # rows of the grid of delays, every 2 degrees of elevation, and twice as many columns
_EDGE = 0.75  # of the highest frequency: 18 kHz at 48 kHz
_FADE = 40  # samples over which the end of a response fades, at most
_QUIETEST = 1e-4  # of the loudest bin: -80 dB, below which a spectrum is not followed
_LEVEL_BAND = (300.0, 6000.0)  # Hz over which the level of all directions together is set to 1
_LOWER_EDGE, _UPPER_EDGE = 500.0, 4000.0  # Hz of the shelves between the three bands


@dataclass(frozen=True, slots=True, eq=False)
class HeadTable:
    """What the mixer needs of a head.

    Attributes:
        tables: For the mixing kernels.
        cells: Its responses, which are filled as they are needed.
        delays: Half the delay of the left ear behind the right on a grid over elevation and azimuth [samples],
            shape [91, 181]: every 2 degrees, azimuth from -180 to 180.
        name: Of the head.
    """

    tables: Tables
    cells: Cells
    delays: F8
    name: str


def build_head_table(head: HeadResponses, rate: int, taps: int = TAPS) -> HeadTable:
    """Compute the tables.

    Args:
        head: At any rate.
        rate: Of the mix.
        taps: Length of the minimum-phase part, at most TAPS; shorter ones are cheaper to store, not to mix.
    """
    pulses = _minimum_phase(head, rate, taps)
    delays = delays_between_ears(head.responses, head.rate)
    lead = np.exp(-2j * np.pi * np.arange(BINS) * BASE_DELAY / SIZE) * _edge()
    spectra = np.fft.rfft(pulses, SIZE)[..., :BINS] * lead
    rows = np.concatenate(([FIRST_CELL], FIRST_CELL + np.cumsum([_columns(degree) for degree in range(181)])))
    cells = aligned_zeros(int(rows[-1]), 4 * BINS)
    for cell, ears in enumerate(((1.0, 1.0), (1.0, 0.0), (0.0, 1.0))):
        cells[cell] = _flat(lead * np.array(ears)[:, None])
    filled = np.zeros(len(cells), np.int64)
    filled[:FIRST_CELL] = 1
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
    """Fades the last quarter of the spectrum: a delay of parts of a sample would ring on at the highest tone."""
    share = np.clip((np.arange(BINS) / BINS - _EDGE) / (1.0 - _EDGE), 0.0, 1.0)
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * share))


def _columns(degree: int) -> int:
    """Cells of a row of the grid: a degree apart or less."""
    return max(1, int(np.ceil(360.0 * np.cos(np.radians(degree - 90.0)) - 1e-9)))


def _flat(pair: NDArray[np.complex128]) -> NDArray[np.float32]:
    """A cell, shape [4 * BINS], of the spectra of left and right, shape [2, BINS]: row of bins by row."""
    parts = np.stack((pair.real, pair.imag), axis=1).reshape(4, ROWS, WIDTH)
    return parts.transpose(1, 0, 2).astype(np.float32).reshape(-1)


def _minimum_phase(head: HeadResponses, rate: int, taps: int) -> F8:
    """Responses of the same magnitude that answer as early as can be, at `rate`, shape [n, 2, taps], level set to 1."""
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
    heard = np.abs(np.fft.rfft(pulses, 512)) ** 2
    band = np.fft.rfftfreq(512, 1.0 / rate)
    inside = (band >= _LEVEL_BAND[0]) & (band <= _LEVEL_BAND[1])
    return np.asarray(pulses / np.sqrt(heard[:, :, inside].mean()))


def _delay_rows(rate: int) -> NDArray[np.float32]:
    """Every half delay as `bins.DELAY_ROW` has it, [rows * DELAY_ROW]."""
    most = half_delay_rows(rate)
    samples = np.arange(-most, most + 1) / DELAYS_PER_SAMPLE
    first, rows = np.arange(WIDTH), WIDTH * np.arange(ROWS)
    angle = -2.0 * np.pi * samples[:, None, None] * np.stack((first, rows)) / SIZE
    return aligned(np.stack((np.cos(angle), np.sin(angle)), axis=2))


def half_delay_rows(rate: int) -> int:
    """Rows of the table of delays on each side of none: up to 0.5 ms, and what the base delay leaves."""
    return int(min(0.5e-3 * rate, BASE_DELAY - 16) * DELAYS_PER_SAMPLE)


def _shelf_rows(rate: int) -> NDArray[np.float32]:
    """What s adds in 1 + s i u / (1 + i u), u = f / edge, a first-order shelf that lifts by the share s, [4 * BINS]."""
    u = np.arange(BINS) * rate / SIZE / np.array([[_LOWER_EDGE], [_UPPER_EDGE]])
    return aligned(np.stack((u * u / (1.0 + u * u), u / (1.0 + u * u)), axis=1))


def _delay_grid(directions: F8, delays: F8) -> F8:
    """A smooth field through the delays of some directions, on the grid of `HeadTable.delays`.

    Polynomials over the ball (as many as an eighth of the directions carry, to the eighth degree) take what is smooth;
    what they leave is blended from the nearest directions, so that at each of them the field is exact.
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
    """All products x^i y^j z^k with i + j + k up to a degree and k at most 1: a basis of the functions on a ball."""
    x, y, z = points.T
    return np.stack(
        [x**i * y**j * z**k for k in (0, 1) for i in range(degree + 1 - k) for j in range(degree + 1 - k - i)],
        axis=-1,
    )
