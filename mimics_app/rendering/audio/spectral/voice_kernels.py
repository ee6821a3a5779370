"""Which voices sound in a block, and which have ended in it."""

from __future__ import annotations

from mimics_app.contracts.arrays import Words
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.audio.spectral.fourier import SIZE
from mimics_app.rendering.audio.spectral.mix_kernels import Bank, State, Voices

__all__ = ["begin_voices", "end_voices"]


_SCHEDULED, _PLAYING, _FADING = int(State.SCHEDULED), int(State.PLAYING), int(State.FADING)


@kernel
def begin_voices(state: Words, begin: Words, wait: Words, position: int, frames: int, order: Words) -> int:
    """Let what starts in a block wait for its frame, and list the rows of all that sound in it.

    Args:
        state: Of each voice, shape [n].
        begin: Frame of its start, likewise.
        wait: Set to the frames of the block before it, likewise.
        position: First frame of the block.
        frames: Of the block.
        order: Set, shape [n].

    Returns:
        How many rows `order` has.
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
    """List the rows among `order` that have faded out, or ended and rung out; return how many `over` has."""
    count = 0
    for n in range(order.shape[0]):
        v = order[n]
        sound = voices.sound[v]
        ended = bank.loops[sound] == 0 and voices.cursor[v] >= bank.length[sound] + SIZE
        if ended or state[v] == _FADING:
            over[count] = v
            count += 1
    return count
