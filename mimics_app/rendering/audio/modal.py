"""Things that are struck, played by the force of the contact as the haptic loop computes it, tick by tick.

A thing is a bank of damped modes. What is heard is the acceleration of its surface: each mode answers to a change of
the force with the derivative of its damped sine, as it does to a pulse in `synth`; and the thing is shaken as a whole,
in proportion to the change of the force (acceleration noise, Richards et al., J. Sound Vib. 62, 1979). So a force that
only rests makes no sound, a fast contact rings, and the slower one is the more of it is thud. Between two ticks the
force is a ramp; a change that the loop has computed in a tick takes place in the millisecond after it, never before.
The modes go on by their exact solution, so how the ticks are cut into calls changes nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4, F8
from mimics_app.rendering.audio.synth import CONTACT_RMS, TAKE_SPREAD
from mimics_app.rendering.audio.synth_scene import MATERIALS

__all__ = ["FORCE_RATE", "ModalVoice", "Modes", "strike_by_force"]


FORCE_RATE = 1000
"""Samples of a force per second: ticks of the haptic loop."""

_LOUDNESS_WINDOW_S = 0.05
_FIRST_SHARE = 0.25
"""Of the largest force of a contact, what a surface with damping gives in the first tick: 1500 N/m with 8 N s/m and a
hand of 3 kg 0.26, whatever the speed."""

_THUD = 0.35
"""Of the thing as a whole, over what rings."""

_MOST_FRAMES = 512
"""Frames that the modes are advanced by at once."""


class Modes:
    """The modes of a material at a rate.

    Args:
        material: Of `MATERIALS`.
        full_force: A contact whose force grows to it, a quarter of it in the first tick, sounds with CONTACT_RMS over
            its first 50 ms [N].
        rate: Samples per second.
        pitch: Ratio that raises it.
        take: Strike points differ in the weights of the modes.

    Attributes:
        falls: Share of a mode that is left after 1, 2, .. frames, with its phase, shape [modes, _MOST_FRAMES].
        grown: What a change of 1 N in every frame has made of a mode after as many, likewise.
        weights: Of each mode in what is heard, shape [modes]: what its real part is worth, and its imaginary one.
        ramp: Frames in which a tick's change of force takes place.
    """

    def __init__(self, material: str, full_force: float, rate: int, pitch: float = 1.0, take: int = 0) -> None:
        frequency, fall, weight = np.array(MATERIALS[material]).T
        frequency, fall = frequency * pitch, fall / pitch
        omega, damping = 2.0 * np.pi * frequency, 3.0 * np.log(10.0) / fall
        pole = np.exp((1.0j * omega - damping) / rate)
        self.ramp = rate // FORCE_RATE
        self.falls = pole[:, None] ** np.arange(1, _MOST_FRAMES + 1)
        self.grown = (1.0 - self.falls) / (1.0 - pole[:, None])
        spread = np.random.default_rng(1000 + take).uniform(1.0 - TAKE_SPREAD, 1.0 + TAKE_SPREAD, len(weight))
        # the derivative of a damped sine, and the sine itself, which follows slow changes: of cos and -sin
        self.weights = weight * spread * omega * (1.0 + 1.0j * damping / omega - 1.0j * _THUD)
        struck = ModalVoice(self).play((_FIRST_SHARE * full_force,), round(_LOUDNESS_WINDOW_S * rate))
        self.weights = self.weights * CONTACT_RMS / np.sqrt(np.mean(struck**2))


class ModalVoice:
    """One thing that sounds; it has been at rest.

    Args:
        modes: Of the thing.
    """

    def __init__(self, modes: Modes) -> None:
        self._modes = modes
        self._state = np.zeros(len(modes.weights), np.complex128)
        self._force = 0.0

    def ring(self, frames: int) -> F8:
        """Go on for some frames under the force there is, shape [frames]."""
        pieces = [self._advance(min(_MOST_FRAMES, frames - done), 0.0) for done in range(0, frames, _MOST_FRAMES)]
        return np.concatenate([np.zeros(0), *pieces])

    def press(self, force: float) -> F8:
        """Let the force become another one [N] over the next `ramp` frames; shape [ramp]."""
        change, self._force = (force - self._force) / self._modes.ramp, force
        return self._advance(self._modes.ramp, change)

    def foresee(self, frames: int) -> F8:
        """What the next frames would be under the force there is, at most _MOST_FRAMES; nothing goes on."""
        return self._heard(self._modes.falls[:, :frames] * self._state[:, None])

    def play(self, forces: Sequence[float] | F8, frames: int) -> F8:
        """Forces of ticks one after the other, then what rings on: shape [frames]."""
        pressed = [self.press(float(force)) for force in forces]
        done = sum(map(len, pressed))
        return np.concatenate([*pressed, self.ring(max(0, frames - done))])[:frames]

    def _advance(self, frames: int, change: float) -> F8:
        """Frames in each of which the force changes by as much [N]."""
        modes = self._modes
        states = modes.falls[:, :frames] * self._state[:, None]
        if change != 0.0:
            states = states + change * modes.grown[:, :frames]
        self._state = states[:, -1]
        # the mean of the jump that a change makes: the sum over all samples is then zero as the integral is
        return self._heard(states) - 0.5 * change * modes.weights.sum().real

    def _heard(self, states: NDArray[np.complex128]) -> F8:
        return np.asarray((self._modes.weights @ states).real)


def strike_by_force(material: str, force: F8, full_force: float = 10.0, rate: int = 48_000) -> F4:
    """What a thing answers to the force of a contact, and a quarter of a second after it.

    Args:
        material: Of `MATERIALS`.
        force: [N] in every tick, shape [n]; before the first there was none.
        full_force: See `Modes`.
        rate: Samples per second.

    Returns:
        In proportion to the force; the first sample belongs to the first tick.
    """
    voice = ModalVoice(Modes(material, full_force, rate))
    return voice.play(force, len(force) * (rate // FORCE_RATE) + rate // 4).astype(np.float32)
