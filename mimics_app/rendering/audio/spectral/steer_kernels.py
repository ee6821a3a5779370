"""Direction, gain, spectrum and pitch of every voice from the geometry of one block.

World frame [m]; the head's axes are right, up and back. The new settings of a voice are compared with its last ones; a
voice whose change would be inaudible keeps them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, Words
from mimics_app.contracts.shared_memory.sound_scene import SOUND_SPEED
from mimics_app.rendering.audio.spectral.cell_kernels import Cells, cell_of, fill_cell
from mimics_app.rendering.audio.spectral.mix_kernels import State, Voices

__all__ = ["CONE", "EXPONENTIAL", "INVERSE", "LINEAR", "MeasuredHead", "Places", "pan_harmonics", "pan_pair", "steer"]


INVERSE, LINEAR, EXPONENTIAL = 0, 1, 2
"""Laws of distance attenuation."""

CONE = 3
"""Columns of a cone: half its inner angle, half its outer angle [rad], outer gain."""

_NEAREST = 1e-3  # m: distance from the centre of the head within which a sound is heard ahead
_FASTEST = 0.5  # limit of velocities in the Doppler shift, relative to the speed of sound
_STEP = 0.004  # relative change of gain that is ignored: 0.03 dB
_SILENT = 1e-6  # gain that counts as silence: -120 dB


_NEPER = np.log(10.0) / 20.0  # nepers per decibel

# Attenuation in air per metre and band, as exp(-x d): 1.3, 5 and 60 dB/km at 250 Hz, 1.4 and 6 kHz, 20 degrees C and
# 50 % humidity (ISO 9613-1).
_AIR_LOW, _AIR_MIDDLE, _AIR_HIGH = 1.3e-3 * _NEPER, 5e-3 * _NEPER, 60e-3 * _NEPER

_LOWEST, _LEFTMOST = 90.0, 180.0
"""Depression and anticlockwise azimuth of the first row and column of the delay grid [degrees]."""

_ROOT_3 = np.sqrt(3.0)
_ROOT_15 = np.sqrt(15.0)
_ROOT_3_8 = np.sqrt(3.0 / 8.0)
_ROOT_5_8 = np.sqrt(5.0 / 8.0)
"""Factors of the SN3D normalisation of spherical harmonics."""


class MeasuredHead(NamedTuple):
    """The listener.

    Attributes:
        position: Position [m], shape [3].
        moving: Velocity [m/s], shape [1, 3].
        axes: Right, up and back, unit vectors, shape [3, 3].
        delays: Delay grid, see `HeadTable`.
        cells: Responses by direction, see `HeadTable`; computed on first use.
        steps: Rows of the table of delays per sample, and on each side of zero, shape [2].
        new: Directions that may still be interpolated in this block; moving sounds keep theirs beyond, shape [1].
    """

    position: F8
    moving: F8
    axes: F8
    delays: F8
    cells: Cells
    steps: Words
    new: Words


class Places(NamedTuple):
    """Scene data of the voices, shape [voices, ..].

    Attributes:
        relative: -1: placed in the world; else the cell of an unspatialised sound.
        position: Position [m], [.., 3].
        velocity: Velocity [m/s], [.., 3].
        forward: Axis of the cone, [.., 3].
        state: State of the voice, see `State`.
        authored: Authored linear gain of the sound.
        level_set: Linear gain set at run time.
        bus: Row of its bus.
        passes: Linear gain past obstacles per band, [.., 3].
        model: INVERSE, LINEAR or EXPONENTIAL.
        fall: Reference distance, largest distance [m], rolloff, [.., 3].
        cone: Cone, [.., CONE].
        doppler: Factor on the Doppler shift.
        pitch_set: Pitch set at run time, before the Doppler shift.
        received: Set to the linear gain at the listener, middle band.
        direction: Set to the unit vector to the voice in the head's axes, [.., 3].
    """

    relative: Words
    position: F8
    velocity: F8
    forward: F8
    state: Words
    authored: F8
    level_set: F8
    bus: Words
    passes: F8
    model: Words
    fall: F8
    cone: F8
    doppler: F8
    pitch_set: F8
    received: F8
    direction: F8


@kernel
def steer(order: Words, places: Places, buses: F8, voices: Voices, head: MeasuredHead) -> None:
    """Set cell, delay, bands, pitch and change flag of some voices for the next block.

    Args:
        order: Rows of the voices, shape [n].
        places: Read; `received` and `direction` are set.
        buses: Linear gain of each bus.
        voices: Set.
        head: Listener.
    """
    places, voices, head = borrowed(places), borrowed(voices), borrowed(head)
    for n in range(order.shape[0]):
        v = order[n]
        level = (
            0.0 if places.state[v] == State.FADING else places.authored[v] * places.level_set[v] * buses[places.bus[v]]
        )
        places.received[v] = level
        shift = 1.0
        cell, half, lower, upper = places.relative[v], head.steps[1], 0.0, 0.0
        if cell < 0:
            x, y, z, distance = _offset(places.position, v, head.position)
            level *= _fall(distance, places.model[v], places.fall[v, 0], places.fall[v, 1], places.fall[v, 2])
            if places.cone[v, 0] < np.pi and distance >= _NEAREST:
                ahead = _along(places.forward, v, x, y, z) / distance
                level *= _cone(-ahead, places.cone[v, 0], places.cone[v, 1], places.cone[v, 2])
            low, middle, high = places.passes[v, 0], places.passes[v, 1], places.passes[v, 2]
            level *= low * np.exp(-_AIR_LOW * distance)
            lower = _louder(middle, low) * np.exp((_AIR_LOW - _AIR_MIDDLE) * distance) - 1.0
            upper = _louder(high, middle) * np.exp((_AIR_MIDDLE - _AIR_HIGH) * distance) - 1.0
            places.received[v] = level * (1.0 + lower)
            if distance >= _NEAREST and places.doppler[v] != 0.0:
                towards, away = _along(places.velocity, v, x, y, z), _along(head.moving, 0, x, y, z)
                shift = _pitch(-towards / distance, -away / distance, places.doppler[v])
            cell, half = _find(x, y, z, distance, head, places.direction, voices, v)
        voices.pitch[v, 1] = shift * places.pitch_set[v]
        _set(voices, v, cell, half, level, lower, upper)


@kernel
def _offset(position: F8, v: int, head: F8) -> tuple[float, float, float, float]:
    """Return the offset from the head to a voice, and the distance [m]."""
    x, y, z = position[v, 0] - head[0], position[v, 1] - head[1], position[v, 2] - head[2]
    return x, y, z, np.sqrt(x * x + y * y + z * z)


@kernel
def _along(vectors: F8, v: int, x: float, y: float, z: float) -> float:
    return vectors[v, 0] * x + vectors[v, 1] * y + vectors[v, 2] * z


@kernel
def _louder(band: float, below: float) -> float:
    """Return the ratio of the gains of two bands."""
    return band / below if below > 0.0 else 1.0


@kernel
def _fall(distance: float, model: int, reference: float, most: float, rolloff: float) -> float:
    """Return the distance attenuation by the clamped laws of OpenAL 1.1."""
    most = max(most, reference)
    d = min(max(distance, reference), most)
    if model == INVERSE:
        return reference / (reference + rolloff * (d - reference))
    if model == LINEAR:
        return max(0.0, 1.0 - rolloff * (d - reference) / (most - reference)) if most > reference else 1.0
    return (d / reference) ** -rolloff


@kernel
def _cone(cosine: float, inner: float, outer: float, least: float) -> float:
    """Return the cone gain by the angle between a voice's axis and the listener, linear between the two angles."""
    angle = np.arccos(min(1.0, max(-1.0, cosine)))
    if angle <= inner:
        return 1.0
    return least if angle >= outer else 1.0 + (least - 1.0) * (angle - inner) / (outer - inner)


@kernel
def _pitch(towards: float, away: float, doppler: float) -> float:
    """Return the Doppler pitch ratio by the radial velocities of source and listener [m/s]."""
    most = _FASTEST * SOUND_SPEED
    towards, away = min(most, max(-most, doppler * towards)), min(most, max(-most, doppler * away))
    return (SOUND_SPEED - away) / (SOUND_SPEED - towards)


@kernel
def _find(
    x: float, y: float, z: float, distance: float, head: MeasuredHead, direction: F8, voices: Voices, v: int
) -> tuple[int, int]:
    """Set the direction of an offset in the head's axes, ahead if inside the head; return cell and row of delays."""
    axes = head.axes
    if distance < _NEAREST:
        direction[v, 0], direction[v, 1], direction[v, 2] = 0.0, 0.0, -1.0
    else:
        for row in range(3):
            direction[v, row] = (axes[row, 0] * x + axes[row, 1] * y + axes[row, 2] * z) / distance
    azimuth = np.arctan2(direction[v, 0], -direction[v, 2])
    elevation = np.arcsin(min(1.0, max(-1.0, direction[v, 1])))
    cell = cell_of(azimuth, elevation, head.cells.rows)
    if head.cells.filled[cell] == 0:
        if head.new[0] <= 0 and voices.changed[v] != 2:
            return voices.cell[v, 1], voices.half[v, 1]
        head.new[0] -= 1
        fill_cell(cell, azimuth, elevation, head.cells)
    half = _half_delay(azimuth, elevation, head.delays) - head.cells.halves[cell]
    most = head.steps[1]
    return cell, most + min(most, max(-most, int(np.rint(half * head.steps[0]))))


@kernel
def _half_delay(azimuth: float, elevation: float, grid: F8) -> float:
    """Return the delay grid, interpolated bilinearly."""
    y = (np.degrees(elevation) + _LOWEST) / 2.0
    x = (np.degrees(azimuth) + _LEFTMOST) / 2.0
    i, j = min(int(y), grid.shape[0] - 2), min(int(x), grid.shape[1] - 2)
    u, w = y - i, x - j
    below = (1.0 - w) * grid[i, j] + w * grid[i, j + 1]
    return (1.0 - u) * below + u * ((1.0 - w) * grid[i + 1, j] + w * grid[i + 1, j + 1])


@kernel
def _set(voices: Voices, v: int, cell: int, half: int, level: float, lower: float, upper: float) -> None:
    """Set a voice where it changes audibly; inaudible changes of its bands are ignored."""
    bands = voices.bands
    if voices.changed[v] == 2:
        voices.pitch[v, 0] = voices.pitch[v, 1]
    else:
        lower, upper = _kept(bands[v, 1, 1], lower, level), _kept(bands[v, 1, 2], upper, level)
        same = voices.cell[v, 1] == cell and voices.half[v, 1] == half
        same = same and bands[v, 1, 1] == lower and bands[v, 1, 2] == upper
        if same and abs(bands[v, 1, 0] - level) <= _STEP * level + _SILENT and (level > 0.0 or bands[v, 1, 0] == 0.0):
            return
        voices.changed[v] = 1
    voices.cell[v, 1], voices.half[v, 1] = cell, half
    bands[v, 1, 0], bands[v, 1, 1], bands[v, 1, 2] = level, lower, upper


@kernel
def _kept(own: float, share: float, level: float) -> float:
    """Return the relative gain of a band: the present one where the difference is inaudible."""
    return own if level == 0.0 or abs(own - share) <= _STEP * (1.0 + share) else share


@kernel
def pan_pair(order: Words, places: Places, voices: Voices, angles: F8, channels: Words, folded: bool) -> None:
    """Set loudspeaker gains by vector-base amplitude panning between the two adjacent loudspeakers (Pulkki 1997).

    Args:
        order: Rows of the voices, shape [n].
        places: Directions of the voices.
        voices: `pan` is set, and `changed` where it differs.
        angles: Clockwise azimuths of the loudspeakers [rad], ascending, shape [m].
        channels: Channel of each loudspeaker, shape [m].
        folded: True without rear loudspeakers: directions behind are mirrored to the front.
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
    """Set third-order ambisonic gains: ACN channels, SN3D normalisation (AmbiX); x ahead, y left, z up."""
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
    """Flag a voice whose channel gains have changed."""
    for channel in range(voices.pan.shape[2]):
        if abs(voices.pan[v, 1, channel] - voices.pan[v, 0, channel]) > _STEP and voices.changed[v] == 0:
            voices.changed[v] = 1
