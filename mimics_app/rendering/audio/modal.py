"""Modal synthesis of struck objects, driven by the contact force that the haptic loop computes in every tick.

An object is a bank of damped modes. The sound is the acceleration of its surface: each mode responds to a change of
force with the derivative of its damped sine, as to a pulse in `synth`, and the object accelerates as a whole in
proportion to the change of force (acceleration noise, Richards et al., J. Sound Vib. 62, 1979). A constant force is
therefore silent, a fast contact rings, and a slow one is mostly thud. Between two ticks the force is a ramp: a change
computed in a tick takes effect over the following millisecond, never before. The modes advance by their exact solution,
so the result does not depend on how ticks are grouped into calls.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.audio.recipe import Modes
from mimics_app.rendering.audio.synth import CONTACT_RMS, TAKE_SPREAD

__all__ = ["FORCE_RATE", "ModalVoice", "ModeBank"]


FORCE_RATE = 1000
"""Samples of the contact force per second: ticks of the haptic loop."""

_LOUDNESS_WINDOW_S = 0.05
_FIRST_SHARE = 0.25
"""Share of a contact's largest force that a damped surface renders in the first tick: 0.26 for 1500 N/m, 8 N s/m and
an effective mass of 3 kg, at any speed."""

_THUD = 0.35
"""Level of the rigid-body acceleration relative to the modes."""

_MOST_FRAMES = 512
"""Largest number of frames by which the modes advance in one call."""


class ModeBank:
    """The modes of a struck object at a rate.

    Args:
        modes: Frequency [Hz], T60 [s] and weight of each.
        full_force: Force [N] of a contact that sounds with CONTACT_RMS over its first 50 ms; a quarter of it acts in
            the first tick.
        rate: Samples per second.
        pitch: Factor on all frequencies.
        take: Number of the strike point, which sets the weights of the modes.

    Attributes:
        falls: Complex decay of each mode after 1, 2, .. frames, shape [modes, _MOST_FRAMES].
        grown: Response of each mode to a change of 1 N per frame after as many frames, same shape.
        weights: Complex weight of each mode in the sound, shape [modes].
        ramp: Number of frames over which a tick's change of force takes effect.
    """

    def __init__(self, modes: Modes, full_force: float, rate: int, pitch: float = 1.0, take: int = 0) -> None:
        frequency, fall, weight = np.array(modes).T
        frequency, fall = frequency * pitch, fall / pitch
        omega, damping = 2.0 * np.pi * frequency, 3.0 * np.log(10.0) / fall
        pole = np.exp((1.0j * omega - damping) / rate)
        self.ramp = rate // FORCE_RATE
        self.falls = pole[:, None] ** np.arange(1, _MOST_FRAMES + 1)
        self.grown = (1.0 - self.falls) / (1.0 - pole[:, None])
        spread = np.random.default_rng(1000 + take).uniform(1.0 - TAKE_SPREAD, 1.0 + TAKE_SPREAD, len(weight))
        # derivative of a damped sine, plus the sine itself for slow changes, on the basis (cos, -sin)
        self.weights = weight * spread * omega * (1.0 + 1.0j * damping / omega - 1.0j * _THUD)
        struck = ModalVoice(self).play((_FIRST_SHARE * full_force,), round(_LOUDNESS_WINDOW_S * rate))
        self.weights = self.weights * CONTACT_RMS / np.sqrt(np.mean(struck**2))


class ModalVoice:
    """A struck object that is at rest at first.

    Args:
        modes: Modes of the object.
    """

    def __init__(self, modes: ModeBank) -> None:
        self._modes = modes
        self._state = np.zeros(len(modes.weights), np.complex128)
        self._force = 0.0

    def decay(self, frames: int) -> F8:
        """Advance by some frames under constant force; return the samples, shape [frames]."""
        pieces = [self._advance(min(_MOST_FRAMES, frames - done), 0.0) for done in range(0, frames, _MOST_FRAMES)]
        return np.concatenate([np.zeros(0), *pieces])

    def apply_force(self, force: float) -> F8:
        """Ramp the force to a new value [N] over the next `ramp` frames; return the samples, shape [ramp]."""
        change, self._force = (force - self._force) / self._modes.ramp, force
        return self._advance(self._modes.ramp, change)

    def predict(self, frames: int) -> F8:
        """Return the next samples under constant force, at most _MOST_FRAMES, without advancing."""
        return self._radiate(self._modes.falls[:, :frames] * self._state[:, None])

    def play(self, forces: Sequence[float] | F8, frames: int) -> F8:
        """Play the forces of consecutive ticks, then the decay; return the samples, shape [frames]."""
        forced = [self.apply_force(float(force)) for force in forces]
        done = sum(map(len, forced))
        return np.concatenate([*forced, self.decay(max(0, frames - done))])[:frames]

    def _advance(self, frames: int, change: float) -> F8:
        """Advance by frames in each of which the force changes by `change` [N]."""
        modes = self._modes
        states = modes.falls[:, :frames] * self._state[:, None]
        if change != 0.0:
            states = states + change * modes.grown[:, :frames]
        self._state = states[:, -1]
        # half of the jump that a change makes, so that the samples sum to zero as the integral does
        return self._radiate(states) - 0.5 * change * modes.weights.sum().real

    def _radiate(self, states: NDArray[np.complex128]) -> F8:
        return np.asarray((self._modes.weights @ states).real)
