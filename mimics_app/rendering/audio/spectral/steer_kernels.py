"""Where every voice is heard from, how loud, how bright and how high: geometry of one block.

World frame [m]; the head's axes are right, up and back. What a voice was set to last is compared with what it would be
set to now: one that has not moved so that anybody could hear it keeps its response.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.audio.spectral.cell_kernels import Cells, cell_of, fill_cell
from mimics_app.rendering.audio.spectral.mix_kernels import State, Voices

__all__ = ["CONE", "EXPONENTIAL", "INVERSE", "LINEAR", "Head", "Places", "pan_harmonics", "pan_pair", "steer"]

Numbers = NDArray[np.float64]
Words = NDArray[np.int64]

INVERSE, LINEAR, EXPONENTIAL = 0, 1, 2
"""How level falls with distance."""

CONE = 3
"""Columns of a cone: half its inner angle, half its outer angle [rad], gain beyond."""

SOUND_SPEED = 343.0
"""[m/s] at 20 degrees C."""

_NEAREST = 1e-3  # m: a sound nearer to the middle of the head than this is heard ahead
_FASTEST = 0.5  # of the speed of sound: motion beyond it changes the pitch no further
_STEP = 0.004  # relative change of a gain that is not followed: 0.03 dB
_SILENT = 1e-6  # gain below which nothing is followed: -120 dB

_FADING = int(State.FADING)

_NEPER = np.log(10.0) / 20.0  # of a decibel

# Loss in air per metre by band, as exp(-x d): 1.3, 5 and 60 dB/km at 250 Hz, 1.4 and 6 kHz, 20 degrees C and 50 %
# humidity (ISO 9613-1).
_AIR_LOW, _AIR_MIDDLE, _AIR_HIGH = 1.3e-3 * _NEPER, 5e-3 * _NEPER, 60e-3 * _NEPER

_LOWEST, _LEFTMOST = 90.0, 180.0
"""Degrees below the horizon and to the left at which the grid of delays begins."""

_ROOT_3 = np.sqrt(3.0)
_ROOT_15 = np.sqrt(15.0)
_ROOT_3_8 = np.sqrt(3.0 / 8.0)
_ROOT_5_8 = np.sqrt(5.0 / 8.0)
"""Of the spherical harmonics' scale SN3D."""


class Head(NamedTuple):
    """The listener.

    Attributes:
        position: [m], shape [3].
        velocity: [m/s], shape [3].
        axes: Right, up and back, unit vectors, shape [3, 3].
        delays: Of `HeadTable`.
        cells: Likewise; filled where sounds come from.
        steps: Rows of the table of delays per sample, and on each side of none, shape [2].
    """

    position: Numbers
    velocity: Numbers
    axes: Numbers
    delays: Numbers
    cells: Cells
    steps: Words


class Places(NamedTuple):
    """What the scene sets of voices, shape [voices, ..].

    Attributes:
        relative: -1: in the world; else the cell of a sound that plays as it is.
        position: [m], [.., 3].
        velocity: [m/s], [.., 3].
        forward: Axis of the cone, [.., 3].
        state: Of `State`.
        authored: Linear gain of the sound itself.
        told: Linear gain it was set to.
        bus: Row of its group.
        passes: Share that obstacles let through, by band, [.., 3].
        model: INVERSE, LINEAR or EXPONENTIAL.
        fall: Reference distance, largest distance [m], rolloff, [.., 3].
        cone: [.., CONE].
        doppler: Factor on the change of pitch.
        heard: Set to the linear gain at the listener, middle band.
        direction: Set to the unit vector to the voice in the head's axes, [.., 3].
    """

    relative: Words
    position: Numbers
    velocity: Numbers
    forward: Numbers
    state: Words
    authored: Numbers
    told: Numbers
    bus: Words
    passes: Numbers
    model: Words
    fall: Numbers
    cone: Numbers
    doppler: Numbers
    heard: Numbers
    direction: Numbers


@kernel
def steer(order: Words, places: Places, buses: Numbers, voices: Voices, head: Head) -> None:
    """Set cell, delay, bands and pitch of some voices for the next block, and whether they changed.

    Args:
        order: Rows of the voices, shape [n].
        places: Read; `heard` and `direction` are set.
        buses: Linear gain of each group.
        voices: Set.
        head: The listener.
    """
    way = np.zeros(3)
    for n in range(order.shape[0]):
        v = order[n]
        level = 0.0 if places.state[v] == _FADING else places.authored[v] * places.told[v] * buses[places.bus[v]]
        if places.relative[v] >= 0:
            places.heard[v] = level
            _tell(voices, v, places.relative[v], head.steps[1], level, level, level)
            continue
        distance = 0.0
        for axis in range(3):
            way[axis] = places.position[v, axis] - head.position[axis]
            distance += way[axis] ** 2
        distance = np.sqrt(distance)
        gain = level * _fall(distance, places.model[v], places.fall[v]) * _cone(way, distance, places, v)
        low = gain * places.passes[v, 0] * np.exp(-_AIR_LOW * distance)
        middle = gain * places.passes[v, 1] * np.exp(-_AIR_MIDDLE * distance)
        high = gain * places.passes[v, 2] * np.exp(-_AIR_HIGH * distance)
        places.heard[v] = middle
        voices.pitch[v, 1] = _pitch(way, distance, places, v, head.velocity)
        if voices.changed[v] == 2:
            voices.pitch[v, 0] = voices.pitch[v, 1]
        _turn_to_head(way, distance, head.axes, places.direction[v])
        azimuth = np.arctan2(places.direction[v, 0], -places.direction[v, 2])
        elevation = np.arcsin(min(1.0, max(-1.0, places.direction[v, 1])))
        cell = cell_of(azimuth, elevation, head.cells.rows)
        fill_cell(cell, azimuth, elevation, head.cells)
        _tell(voices, v, cell, _delay_row(azimuth, elevation, cell, head), low, middle, high)


@kernel
def _tell(voices: Voices, v: int, cell: int, half: int, low: float, middle: float, high: float) -> None:
    """Hand a voice what it is to be, where that is not what it is."""
    bands = voices.bands[v, 1]
    same = voices.cell[v, 1] == cell and voices.half[v, 1] == half and voices.changed[v] != 2
    same = same and abs(bands[0] - low) <= _STEP * low + _SILENT and abs(bands[1] - middle) <= _STEP * middle + _SILENT
    if same and abs(bands[2] - high) <= _STEP * high + _SILENT and (low > 0.0 or bands[0] == 0.0):
        return
    voices.cell[v, 1], voices.half[v, 1] = cell, half
    bands[0], bands[1], bands[2] = low, middle, high
    if voices.changed[v] == 0:
        voices.changed[v] = 1


@kernel
def _fall(distance: float, model: int, fall: Numbers) -> float:
    """Gain by distance: the clamped laws of OpenAL 1.1, which are those of most engines."""
    reference, most, rolloff = fall[0], max(fall[1], fall[0]), fall[2]
    d = min(max(distance, reference), most)
    if model == INVERSE:
        return reference / (reference + rolloff * (d - reference))
    if model == LINEAR:
        return max(0.0, 1.0 - rolloff * (d - reference) / (most - reference)) if most > reference else 1.0
    return (d / reference) ** -rolloff


@kernel
def _cone(way: Numbers, distance: float, places: Places, v: int) -> float:
    """Gain by the angle between a voice's axis and the way to the listener, blended between the two angles."""
    inner, outer, least = places.cone[v, 0], places.cone[v, 1], places.cone[v, 2]
    if inner >= np.pi or distance < _NEAREST:
        return 1.0
    cosine = 0.0
    for axis in range(3):
        cosine -= way[axis] * places.forward[v, axis]
    angle = np.arccos(min(1.0, max(-1.0, cosine / distance)))
    if angle <= inner:
        return 1.0
    return least if angle >= outer else 1.0 + (least - 1.0) * (angle - inner) / (outer - inner)


@kernel
def _pitch(way: Numbers, distance: float, places: Places, v: int, velocity: Numbers) -> float:
    """Ratio of pitches by motion along the way, of source and of listener (Doppler)."""
    if distance < _NEAREST or places.doppler[v] == 0.0:
        return 1.0
    towards, away = 0.0, 0.0
    for axis in range(3):
        towards -= places.velocity[v, axis] * way[axis]
        away -= velocity[axis] * way[axis]
    most = _FASTEST * SOUND_SPEED
    towards = min(most, max(-most, places.doppler[v] * towards / distance))
    away = min(most, max(-most, places.doppler[v] * away / distance))
    return (SOUND_SPEED - away) / (SOUND_SPEED - towards)


@kernel
def _turn_to_head(way: Numbers, distance: float, axes: Numbers, direction: Numbers) -> None:
    """Unit vector in the head's axes; straight ahead for what is inside the head."""
    for row in range(3):
        direction[row] = 0.0
        if distance >= _NEAREST:
            for axis in range(3):
                direction[row] += axes[row, axis] * way[axis] / distance
    if distance < _NEAREST:
        direction[2] = -1.0


@kernel
def _delay_row(azimuth: float, elevation: float, cell: int, head: Head) -> int:
    """Row of the table of delays: the grid blended between its four nearest points, less what the cell has itself."""
    grid = head.delays
    y = (np.degrees(elevation) + _LOWEST) / 2.0
    x = (np.degrees(azimuth) + _LEFTMOST) / 2.0
    i, j = min(int(y), grid.shape[0] - 2), min(int(x), grid.shape[1] - 2)
    u, w = y - i, x - j
    half = (1.0 - u) * ((1.0 - w) * grid[i, j] + w * grid[i, j + 1])
    half += u * ((1.0 - w) * grid[i + 1, j] + w * grid[i + 1, j + 1])
    most = head.steps[1]
    return most + min(most, max(-most, int(np.rint((half - head.cells.halves[cell]) * head.steps[0]))))


@kernel
def pan_pair(order: Words, places: Places, voices: Voices, angles: Numbers, channels: Words, folded: bool) -> None:
    """Gains of loudspeakers: the two beside the direction share the power (Pulkki 1997).

    Args:
        order: Rows of the voices, shape [n].
        places: Their directions.
        voices: `pan` is set, and `changed` where it moved.
        angles: Azimuths of the loudspeakers to the right [rad], ascending, shape [m].
        channels: Channel of each.
        folded: True where there are none behind: what is there is heard as if mirrored to the front.
    """
    count = angles.shape[0]
    for n in range(order.shape[0]):
        v = order[n]
        pan = voices.pan[v, 1]
        pan[:] = 0.0
        azimuth = np.arctan2(places.direction[v, 0], -places.direction[v, 2])
        if places.relative[v] >= 0:
            azimuth = 0.0 if places.relative[v] == 0 else angles[0 if places.relative[v] == 1 else count - 1]
        if folded:
            azimuth = np.arcsin(min(1.0, max(-1.0, np.sin(azimuth))))
            azimuth = min(angles[count - 1], max(angles[0], azimuth))
        right = 0
        while right < count and angles[right] < azimuth:
            right += 1
        left, right = (right - 1) % count, right % count
        gap = (angles[right] - angles[left]) % (2.0 * np.pi)
        past = (azimuth - angles[left]) % (2.0 * np.pi)
        a, b = np.sin(gap - past), np.sin(past)
        size = np.sqrt(a * a + b * b)
        pan[channels[left]], pan[channels[right]] = a / size, b / size
        _note_pan(voices, v)


@kernel
def pan_harmonics(order: Words, places: Places, voices: Voices) -> None:
    """Spherical harmonics of third order, channels as in ACN, scaled as in SN3D (AmbiX): x ahead, y left, z up."""
    for n in range(order.shape[0]):
        v = order[n]
        pan = voices.pan[v, 1]
        x, y, z = -places.direction[v, 2], -places.direction[v, 0], places.direction[v, 1]
        pan[:] = 0.0
        pan[0] = 1.0
        if places.relative[v] < 0:
            pan[1], pan[2], pan[3] = y, z, x
            pan[4], pan[5] = _ROOT_3 * x * y, _ROOT_3 * y * z
            pan[6], pan[7] = 0.5 * (3.0 * z * z - 1.0), _ROOT_3 * x * z
            pan[8] = 0.5 * _ROOT_3 * (x * x - y * y)
            pan[9] = _ROOT_5_8 * y * (3.0 * x * x - y * y)
            pan[10], pan[11] = _ROOT_15 * x * y * z, _ROOT_3_8 * y * (5.0 * z * z - 1.0)
            pan[12], pan[13] = 0.5 * z * (5.0 * z * z - 3.0), _ROOT_3_8 * x * (5.0 * z * z - 1.0)
            pan[14] = 0.5 * _ROOT_15 * z * (x * x - y * y)
            pan[15] = _ROOT_5_8 * x * (x * x - 3.0 * y * y)
        _note_pan(voices, v)


@kernel
def _note_pan(voices: Voices, v: int) -> None:
    """Mark a voice whose gains have moved."""
    for channel in range(voices.pan.shape[2]):
        if abs(voices.pan[v, 1, channel] - voices.pan[v, 0, channel]) > _STEP and voices.changed[v] == 0:
            voices.changed[v] = 1
