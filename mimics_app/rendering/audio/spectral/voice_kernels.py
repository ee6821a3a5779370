"""Scheduling of voices: which start and sound in a block, and which end in it."""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Words
from mimics_app.rendering.audio.spectral.fourier import SIZE
from mimics_app.rendering.audio.spectral.mix_kernels import Bank, State, Voices

__all__ = ["begin_voices", "end_voices"]


_SCHEDULED, _PLAYING, _FADING = int(State.SCHEDULED), int(State.PLAYING), int(State.FADING)


@kernel
def begin_voices(state: Words, begin: Words, wait: Words, position: int, frames: int, order: Words) -> int:
    """Schedule the voices that start in a block, and list the rows of all that sound in it.

    Args:
        state: State of each voice, shape [n].
        begin: Start frame of each voice, shape [n].
        wait: Set to the frames of the block before the start, shape [n].
        position: First frame of the block.
        frames: Number of frames of the block.
        order: Set to the rows, shape [n].

    Returns:
        Number of rows in `order`.
    """
    count = 0
    for v in range(state.shape[0]):
        if state[v] == _SCHEDULED and begin[v] < position + frames:
            wait[v], state[v] = max(0, begin[v] - position), _PLAYING
        if state[v] >= _PLAYING:
            order[count] = v
            count += 1
    return count


@kernel
def end_voices(state: Words, order: Words, voices: Voices, bank: Bank, over: Words) -> int:
    """List in `over` the rows among `order` that have ended or faded out; return their number."""
    count = 0
    for n in range(order.shape[0]):
        v = order[n]
        sound = voices.sound[v]
        ended = bank.loops[sound] == 0 and voices.cursor[v] >= bank.length[sound] + SIZE
        if ended or state[v] == _FADING:
            over[count] = v
            count += 1
    return count
