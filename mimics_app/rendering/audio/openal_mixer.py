"""The OpenAL mixer: named sounds in, spatial sound out, with sample-exact starts on a loopback.

A loopback starts a sound at frame `round((t - origin) * rate) + latency`, a late one at once: `render` splits its block
at every start, because the library starts sounds only at the beginning of a render call. A live device renders in a
thread of the library; there a sound starts with the next period.
OpenAL Soft of the stable distributions stops a sound with a click (-23 dBFS); therefore a stop fades to zero over one
render call first.
"""

from __future__ import annotations

import ctypes
import heapq
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from functools import partial
from math import degrees

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.audio_port import ListenerState, Start, Timing, frame_at
from mimics_app.rendering.audio.bank import Sound, SoundBank, fill_memory
from mimics_app.rendering.audio.openal_context import OpenALContext
from mimics_app.rendering.audio.openal_library import AL
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec

__all__ = ["SPARE_SOURCES", "OpenALMixer"]


SPARE_SOURCES = 8
"""Sources beside those of the voices, for sounds that fade out."""


_FADE_FRAMES = 960  # kept after the last sample, for the filters' decay: 20 ms
_SHORTEST_RAMP = 64  # frames; in a shorter piece no gain changes
_AUDIBLE_CHANGE = 0.02  # relative change of a gain that is sent
_AUDIBLE_PITCH = 0.002  # of pure tones at 1 kHz (C. C. Wier et al., J. Acoust. Soc. Am. 61, 1977)
_AHEAD: Vec3 = (0.0, 0.0, -1.0)

_LEAD_S = 0.005
"""Lead-in of a force-driven sound on a live device [s]: the library renders a whole period at once, and the force of a
tick is read up to 1 ms after the tick."""


class _State(IntEnum):
    FREE = 0
    SCHEDULED = 1
    PLAYING = 2
    FADING = 3


@dataclass(slots=True)
class _Voice:
    source: int
    state: _State = _State.FREE
    handle: int = 0
    sound: str = ""
    authored: float = 1.0
    priority: float = 1.0
    gain: float = 0.0
    pitch: float = 1.0
    end: int | None = None


class OpenALMixer:
    """See contracts.ports.audio_port.Mixer.

    Attributes:
        context: Context it plays on.
    """

    def __init__(
        self, context: OpenALContext, bank: SoundBank, settings: AudioSettings, clock: Clock, timing: Timing
    ) -> None:
        self.context = context
        self.rate = context.rate
        self.channels = 2
        self.hrtf = context.hrtf
        self.timing = timing
        self.position = 0
        self.refused = 0
        self._library = context.library
        self._call = context.library.call
        self._bank = bank
        self._limit = settings.voices
        self._clock = clock
        self._handles = 0
        self._changes: list[Callable[[], object]] = []
        self._due: list[tuple[int, int, _Voice]] = []
        self._by_handle: dict[int, _Voice] = {}
        try:
            context.activate()
            self._buffers = self._upload()
            self._filled = self._map_live()
            self._voices = [_Voice(source) for source in self._generate_sources(settings.voices + SPARE_SOURCES)]
        except DeviceError:
            context.close()
            raise

    def start(self, sound: str, t_ns: int, position_world: Vec3 | None, gain: float) -> Start:
        """Start a sound; its handle is 0 when no voice was free. KeyError: no such sound."""
        content = self._bank[sound]
        voice = self._find_voice(content.spec.gain * gain * content.spec.priority)
        if voice is None:
            self.refused += 1
            return Start(0, -1, late=False)
        self._handles += 1
        voice.sound, voice.priority = sound, content.spec.priority
        voice.handle, voice.authored, voice.gain = self._handles, content.spec.gain, content.spec.gain * gain
        voice.pitch = 1.0
        self._by_handle[voice.handle] = voice
        self._prepare(voice, sound, content, position_world)
        if not self.context.loopback:
            self._play(voice, self._now_frame(), content)
            return Start(voice.handle, -1, late=False)
        wanted = frame_at(t_ns, self.timing.origin_ns, self.context.rate) + self.timing.latency
        frame = max(wanted, self.position)
        voice.state = _State.SCHEDULED
        voice.end = None if content.spec.loop else frame + len(content.samples) + _FADE_FRAMES
        heapq.heappush(self._due, (frame, voice.handle, voice))
        return Start(voice.handle, frame, late=frame > wanted)

    def first_sample(self, start: Start, submitted_ns: int) -> tuple[int, int]:
        """Return the frame of a sound's first sample (-1: unknown) and the session time by which it is heard [ns]."""
        if start.frame < 0:
            pipeline_ms = self.timing.pipeline / self.context.rate * 1e3
            return -1, submitted_ns + round((self.context.buffered_ms + pipeline_ms) * 1e6)
        frame = start.frame + self.timing.pipeline
        return frame, self.timing.origin_ns + frame * 1_000_000_000 // self.context.rate

    def set_listener(self, state: ListenerState) -> None:
        """Set the poses of listener and sounds; the library ramps gains over one render call.

        Of the gains past obstacles only the middle band is used, as the level.
        """
        orientation = (ctypes.c_float * 6)(*state.head_forward, *state.head_up)
        call = self._call
        self._change(call.alListener3f, AL.POSITION, *state.head_position)
        self._change(call.alListener3f, AL.VELOCITY, *state.head_velocity)
        self._change(call.alListenerfv, AL.ORIENTATION, orientation)
        for row, handle in enumerate(state.handles):
            voice = self._by_handle.get(int(handle))
            if voice is None or voice.state == _State.FADING:
                continue
            self._set_gain(voice, voice.authored * float(state.gain[row] * state.passes[row, 1]))
            self._set_pitch(voice, float(state.pitch[row]))
            if not self._bank[voice.sound].spec.spatial:
                continue
            if np.isfinite(state.position[row]).all() and np.isfinite(state.velocity[row]).all():
                self._change(call.alSource3f, voice.source, AL.POSITION, *state.position[row])
                self._change(call.alSource3f, voice.source, AL.VELOCITY, *state.velocity[row])
                self._change(call.alSource3f, voice.source, AL.DIRECTION, *state.forward[row])

    def _set_gain(self, voice: _Voice, gain: float) -> None:
        """Change the gain of a voice where the change is audible."""
        if abs(gain - voice.gain) > _AUDIBLE_CHANGE * (gain + voice.gain):
            voice.gain = gain
            self._change(self._call.alSourcef, voice.source, AL.GAIN, gain)

    def _set_pitch(self, voice: _Voice, pitch: float) -> None:
        """Change the pitch of a voice where the change is audible."""
        if abs(pitch - voice.pitch) > _AUDIBLE_PITCH * voice.pitch:
            voice.pitch = pitch
            self._change(self._call.alSourcef, voice.source, AL.PITCH, pitch)

    def stop(self, handle: int) -> None:
        """Fade a sound out; its voice is free once the fade has been played."""
        voice = self._by_handle.get(handle)
        if voice is not None:
            self._fade(voice)

    def master(self, value: float) -> None:
        """Set the linear gain of everything."""
        self._change(self._call.alListenerf, AL.GAIN, value)

    @property
    def lead(self) -> int | None:
        """Lead-in of force-driven sounds [frames]: a live device reads ahead of the newest force."""
        if self._bank.live and not self._filled:
            return None
        return 0 if self.context.loopback else round(_LEAD_S * self.rate)

    def fill(self, handle: int, begin: int, samples: NDArray[np.float32]) -> None:
        """Write samples of a playing sound from its sample `begin` on, of a loop round its end."""
        voice = self._by_handle.get(handle)
        if voice is None:
            return
        sound, memory = self._bank[voice.sound], self._filled[voice.sound]
        if sound.other is not None:  # see `_both_channels`
            begin += self.timing.pipeline
        fill_memory(memory, begin, samples, loop=sound.spec.loop)

    def render(self, frames: int) -> NDArray[np.float32]:
        """Render the next frames, shape [frames, 2], not limited to full scale; shape [0, 2] on a live device."""
        if not self.context.loopback:
            return np.zeros((0, 2), np.float32)
        self.context.activate()
        out = np.zeros((frames, 2), np.float32)
        done = 0
        while done < frames:
            self._launch()
            rest = frames - done
            piece = min(rest, self._due[0][0] - self.position) if self._due else rest
            if piece >= _SHORTEST_RAMP or piece == rest:
                self._apply_changes()  # on a segment long enough for the library to ramp over
            self.context.render_into(out[done : done + piece])
            done += piece
            self.position += piece
        return out

    def connected(self) -> bool:
        """False once the device has gone."""
        return self.context.connected

    def close(self) -> None:
        """Close the device."""
        self.context.close()

    def _upload(self) -> dict[str, int]:
        buffers: dict[str, int] = {}
        second = {sound.other for sound in self._bank.sounds.values()}
        for name, sound in self._bank.sounds.items():
            if name in second:  # it is in the buffer of the first channel
                continue
            buffer = ctypes.c_uint()
            self._call.alGenBuffers(1, ctypes.byref(buffer))
            form = AL.FORMAT_MONO_FLOAT32 if sound.spec.spatial else AL.FORMAT_STEREO_FLOAT32
            samples = sound.samples if sound.spec.spatial else self._both_channels(sound)
            self._call.alBufferData(buffer.value, form, samples.ctypes.data, samples.nbytes, self._bank.rate)
            self._library.check(f'take the sound "{name}"')
            buffers[name] = buffer.value
        return buffers

    def _both_channels(self, sound: Sound) -> NDArray[np.float32]:
        """Return the samples of a sound that is played as recorded, shape [n, 2]; one channel plays on both sides.

        They bypass the filters, whose delay stands before them; a loop has no beginning that would show it.
        """
        second = sound if sound.other is None else self._bank[sound.other]
        delay = 0 if sound.spec.loop else self.timing.pipeline
        return np.pad(np.stack((sound.samples, second.samples), axis=1), ((delay, 0), (0, 0)))

    def _map_live(self) -> dict[str, NDArray[np.float32]]:
        """Map the buffers of sounds that are filled while they play; none where the library cannot.

        Raises:
            DeviceError: It cannot, and one of them is too long to be held.
        """
        if self._bank.streams and not self._library.maps:
            raise DeviceError("this OpenAL plays no sound longer than a minute", "install OpenAL Soft 1.19 or newer")
        filled: dict[str, NDArray[np.float32]] = {}
        second = {sound.other for sound in self._bank.live.values()}
        for name, sound in self._bank.live.items() if self._library.maps else ():
            if name in second:
                continue
            shape = (len(sound.samples),) if sound.other is None else (len(sound.samples), 2)
            silence = np.zeros(shape, np.float32)
            form = AL.FORMAT_MONO_FLOAT32 if sound.other is None else AL.FORMAT_STEREO_FLOAT32
            buffer, size, access = ctypes.c_uint(), silence.nbytes, AL.MAP_WRITE | AL.MAP_PERSISTENT
            self._call.alGenBuffers(1, ctypes.byref(buffer))
            self._call.alBufferStorageSOFT(buffer.value, form, silence.ctypes.data, size, self._bank.rate, access)
            place = self._call.alMapBufferSOFT(buffer.value, 0, size, access)
            self._library.check(f'share the memory of "{name}"')
            memory = (ctypes.c_float * silence.size).from_address(place)
            filled[name], self._buffers[name] = np.ctypeslib.as_array(memory).reshape(shape), buffer.value
        return filled

    def _generate_sources(self, count: int) -> list[int]:
        sources = (ctypes.c_uint * count)()
        self._call.alGenSources(count, sources)
        self._library.check(f"make {count} voices")
        return list(sources)

    def _prepare(self, voice: _Voice, name: str, sound: Sound, position_world: Vec3 | None) -> None:
        self.context.activate()
        call, source = self._call, voice.source
        position = position_world if sound.spec.spatial else None
        call.alSourcei(source, AL.BUFFER, self._buffers[name])
        call.alSourcei(source, AL.LOOPING, int(sound.spec.loop))
        call.alSourcei(source, AL.DIRECT_CHANNELS, int(not sound.spec.spatial))
        call.alSourcei(source, AL.SOURCE_RELATIVE, int(position is None))
        call.alSource3f(source, AL.POSITION, *(position or _AHEAD))
        call.alSourcef(source, AL.REFERENCE_DISTANCE, sound.spec.reference_distance)
        call.alSourcef(source, AL.MAX_DISTANCE, max(sound.spec.max_distance, sound.spec.reference_distance))
        call.alSourcef(source, AL.ROLLOFF_FACTOR, sound.spec.rolloff)
        call.alSourcef(source, AL.GAIN, voice.gain)
        call.alSourcef(source, AL.PITCH, 1.0)
        self._aim(source, sound.spec)
        self._library.check(f'prepare the sound "{name}"')

    def _aim(self, source: int, spec: SoundSpec) -> None:
        """Set velocity to zero and the cone of a source."""
        self._call.alSource3f(source, AL.VELOCITY, 0.0, 0.0, 0.0)
        self._call.alSourcef(source, AL.CONE_INNER_ANGLE, min(360.0, degrees(spec.cone_inner)))
        self._call.alSourcef(source, AL.CONE_OUTER_ANGLE, min(360.0, degrees(spec.cone_outer)))
        self._call.alSourcef(source, AL.CONE_OUTER_GAIN, spec.cone_gain)

    def _play(self, voice: _Voice, frame: int, sound: Sound) -> None:
        self._call.alSourcePlay(voice.source)
        self._library.check("play a sound")
        voice.state = _State.PLAYING
        voice.end = None if sound.spec.loop else frame + len(sound.samples) + self.context.rate // 10

    def _launch(self) -> None:
        """Play every sound whose start frame is reached."""
        while self._due and self._due[0][0] <= self.position:
            voice = heapq.heappop(self._due)[2]
            if voice.state == _State.SCHEDULED:
                self._call.alSourcePlay(voice.source)
                self._library.check("play a sound")
                voice.state = _State.PLAYING

    def _find_voice(self, level: float) -> _Voice | None:
        """Return a free source; at the voice limit the quietest sound is stolen if it is quieter than the new one.

        Levels are gain times priority, without the distance.
        """
        self._collect()
        busy = [voice for voice in self._voices if voice.state in (_State.SCHEDULED, _State.PLAYING)]
        if len(busy) >= self._limit:
            quietest = min(busy, key=lambda voice: voice.gain * voice.priority)
            if quietest.gain * quietest.priority >= level:
                return None
            self._fade(quietest)
        return next((voice for voice in self._voices if voice.state == _State.FREE), None)

    def _fade(self, voice: _Voice) -> None:
        if voice.state == _State.SCHEDULED:
            self._free(voice)
        elif voice.state == _State.PLAYING:
            voice.state = _State.FADING
            voice.end = self._now_frame() + _FADE_FRAMES
            self._change(self._call.alSourcef, voice.source, AL.GAIN, 0.0)

    def _collect(self) -> None:
        """Free the voices whose sound has ended or faded out."""
        now = self._now_frame()
        for voice in self._voices:
            if voice.state in (_State.PLAYING, _State.FADING) and voice.end is not None and now >= voice.end:
                self.context.activate()
                self._call.alSourceStop(voice.source)
                self._free(voice)

    def _free(self, voice: _Voice) -> None:
        self._by_handle.pop(voice.handle, None)
        self._due = [entry for entry in self._due if entry[2] is not voice]
        heapq.heapify(self._due)
        voice.state = _State.FREE

    def _change(self, function: Callable[..., object], *arguments: object) -> None:
        """Call a function of the library before the next block, which ramps to the change; at once on a live device."""
        self._changes.append(partial(function, *arguments))
        if not self.context.loopback:
            self.context.activate()
            self._apply_changes()

    def _apply_changes(self) -> None:
        for change in self._changes:
            change()
        self._changes.clear()

    def _now_frame(self) -> int:
        if self.context.loopback:
            return self.position
        return frame_at(self._clock.now_ns(), self.timing.origin_ns, self.context.rate)
