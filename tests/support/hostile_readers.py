"""Every reader of a file that people write, and every wire, each with something that it takes: what attacks begin with.

`python -m tests.support.hostile_readers FOLDER` gives each of them every attack, and prints an object of what happened;
what a process must not do meanwhile is seen by an audit hook.
"""

from __future__ import annotations

import io
import json
import os
import re
import struct
import sys
import time
import wave
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from mimics_app.app.commands.check import examine
from mimics_app.app.scenes.person_edit import read_fit
from mimics_app.app.study.protocol import read_protocol
from mimics_app.app.study.study_folder import StudyFolder
from mimics_app.app.sweep.experiments import NAMES, find_experiment
from mimics_app.app.terminal.user_files import read_strictly
from mimics_app.console.page_server import _ASKS
from mimics_app.contracts.commands.vocabulary import read_command
from mimics_app.contracts.errors import MimicsError
from mimics_app.contracts.messages.mirror_frame import MirrorFrame, read_frame, write_frame
from mimics_app.contracts.ports import method_table
from mimics_app.contracts.system.machine_memory import MachineMemory
from mimics_app.contracts.system.resources import root
from mimics_app.inputs.commands.command_file import read_command_file
from mimics_app.inputs.commands.marker_stream import command_of_marker
from mimics_app.inputs.physio.amplifier_frames import AmplifierReader
from mimics_app.inputs.physio.recording import read_signal_file
from mimics_app.inputs.trackers.ascension import FlockParser, flock_record
from mimics_app.inputs.trackers.osc_wire import read_datagram
from mimics_app.inputs.trackers.polhemus import FastrakParser, fastrak_record
from mimics_app.inputs.trackers.tape import read_tape
from mimics_app.inputs.trackers.vrpn_wire import COOKIE, MessageReader, announcement, pack, pose_body
from mimics_app.lab.sweep.spec import load_sweep
from mimics_app.recording.run import Run
from mimics_app.rendering.audio.queue_need import QueueNeed, known_needed_ms
from mimics_app.rendering.audio.sound_file import read_sound
from mimics_app.rendering.audio.spectral.sofa import read_sofa
from mimics_app.rendering.haptic.devices import serial_frames
from mimics_app.rendering.haptic.devices.hapticmaster_text import take_answer
from mimics_app.rendering.haptic.tunnel_source import read_path
from mimics_app.rendering.tactile.wire import read_answers
from mimics_app.rendering.visual.displays.headset_file import load_headset
from mimics_app.rendering.visual.displays.wall_file import load_walls
from mimics_app.tasks.trial_file import load_blocks
from mimics_app.world.files.capture.bvh import read_bvh
from mimics_app.world.files.capture.c3d_file import read_c3d
from mimics_app.world.files.gltf.file import load_gltf
from mimics_app.world.files.people.measures_file import read_measures

__all__ = ["ATTACKS", "READERS", "SECRET", "WIRES", "Reader"]

SECRET = b"nobody reads this"
"""Content of the file beside the folder that no reader may open."""


@dataclass(frozen=True)
class Reader:
    """What reads.

    Attributes:
        suffix: Name of its file, or end of that name.
        original: What it takes.
        read: Reads a file; of a wire: takes bytes.
    """

    suffix: str
    original: bytes
    read: Callable[[Any], object]


def _text(value: object) -> bytes:
    return json.dumps(value).encode()


def _sound() -> bytes:
    made = io.BytesIO()
    with wave.open(made, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(8000)
        file.writeframes(bytes(800))
    return made.getvalue()


def _sofa() -> bytes:
    import h5py

    made = io.BytesIO()
    with h5py.File(made, "w") as file:
        file.attrs["SOFAConventions"] = np.bytes_("SimpleFreeFieldHRIR")
        file["Data.IR"] = np.eye(24, 64).reshape(-1, 2, 64) * 0.5
        file["Data.SamplingRate"] = np.array([44100.0])
        file["SourcePosition"] = np.array([[30.0 * i, 0.0, 1.4] for i in range(12)])
        file["SourcePosition"].attrs["Type"] = np.bytes_("spherical")
    return made.getvalue()


_BVH = """HIERARCHY
ROOT hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  End Site
  {
    OFFSET 0 -2 0
  }
}
MOTION
Frames: 2
Frame Time: 0.5
0 95 0 0 0 0
0 95 1 0 5 0
"""
_GLTF = {
    "asset": {"version": "2.0"},
    "nodes": [{"name": "A"}],
    "scenes": [{"nodes": [0]}],
    "buffers": [{"uri": "data:application/octet-stream;base64,AAAAAA==", "byteLength": 4}],
    "images": [],
}
_EYE = {"tangents": [-1.0, 1.0, -1.1, 1.1], "position": [0.0, 0.0, 0.0]}
_WALL = {"name": "front", "lower_left": [-1, 0, -1], "lower_right": [1, 0, -1], "upper_left": [-1, 2, -1]}
_SWEEP = {"format": "mimics-sweep", "version": 1, "experiment": "wall_stability", "parameters": {"mass": [1.0, 2.0]}}
_TAPE = {"sensor": "head", "t_ns": 1, "position": [0, 1, 0], "rotation": [0, 0, 0, 1]}
_ROW = {"method": "m", "cost_us": 1.0, "ratio": 2.0, "error": None, "unit": "N", "settings": {"steps": 2}}
_COSTS = {"machine": {}, "reference_us": {"a group": 1.8}, "groups": {"a group": [_ROW]}}
_GRIP = {"name": "grip", "value": 41.0, "unit": "N", "repeats": 3, "spread": 2.0}
_HEARING = {"name": "hearing_left", "value": -40.0, "unit": "dB", "repeats": 3, "spread": 1.0}
_FIT = {"calibration": {"measures": {"grip": _GRIP, "hearing_left": _HEARING}}, "limits": {"grip": 0.5}}
_STUDY = {"format": "mimics study", "version": 1, "conditions": {"a": {"scene": "wavy_tunnel"}}}
_STUDY |= {"blocks": [{"conditions": ["a"]}]}


def _study(path: Path) -> None:
    read_protocol(path)
    study = StudyFolder(path.parent)
    for participant in study.participants:
        study.plan(participant, 1)


def _run(path: Path) -> None:
    run = Run.open(path.parent)
    run.problems()
    run.session.get("settings")


def _settings(path: Path) -> None:
    os.environ["XDG_CONFIG_HOME"] = str(path.parents[1])
    read_strictly("ceiling")


def _costs(path: Path) -> None:
    """Read the costs measured on this machine, as from the file that is kept for it."""
    kept, method_table.saved_file = method_table.saved_file, lambda: path
    try:
        method_table.Table.load_saved()
    finally:
        method_table.saved_file = kept


READERS: dict[str, Reader] = {
    "scene": Reader(".json", (root() / "scenes/examples/surfaces.json").read_bytes(), examine),
    "glTF": Reader(".gltf", _text(_GLTF), load_gltf),
    "BVH": Reader(".bvh", _BVH.encode(), read_bvh),
    "C3D": Reader(".c3d", bytes((2, 0x50)) + bytes(1022), read_c3d),
    "SOFA": Reader(".sofa", _sofa(), read_sofa),
    "sound": Reader(".wav", _sound(), lambda path: read_sound(path, 48_000)),
    "recording": Reader("session.json", _text({"format": "mimics run", "version": 1, "seed": 1}), _run),
    "study": Reader("study.json", _text(_STUDY), _study),
    "sweep": Reader(".json", _text(_SWEEP), lambda path: load_sweep(path, find_experiment, NAMES)),
    "trials": Reader(".json", _text([{"name": "A", "trials": [{"label": "easy", "values": {}}]}]), load_blocks),
    "path as JSON": Reader(".json", _text([[0.1 * i, 0.0, 0.1] for i in range(8)]), read_path),
    "path as CSV": Reader(".csv", b"x,y,z\n0,0,0\n0.1,0,0\n0.2,0,0\n0.3,0,0\n", read_path),
    "commands": Reader(".json", _text([{"t": 1.0, "command": "pause"}]), read_command_file),
    "walls": Reader(".json", _text({"format": "mimics.walls/1", "walls": [_WALL]}), load_walls),
    "headset": Reader(".json", _text({"left": _EYE, "right": _EYE}), load_headset),
    "tracker tape": Reader(".jsonl", _text(_TAPE) + b"\n", lambda path: list(read_tape(path))),
    "body signals": Reader(".csv", b"t [s],ecg [mV]\n0,0.1\n0.004,0.2\n0.008,0.1\n", read_signal_file),
    "EDF": Reader(".edf", b"0       ".ljust(256), read_signal_file),
    "measures of a person": Reader(".json", _text({"waist": 0.86, "upper_arm": 0.33}), read_measures),
    "fit": Reader(".json", _text(_FIT), read_fit),
    "costs of methods": Reader(".json", _text(_COSTS), _costs),
    "settings": Reader("mimics/ceiling.json", _text({"force": 20.0}), _settings),
    "machine memory": Reader(
        ".json", _text({"live": {"ms": [1.0]}}), lambda path: known_needed_ms(MachineMemory(QueueNeed, path))
    ),
}
"""Readers of files by what they read."""


def _serial(data: bytes) -> None:
    line, buffer = np.zeros(serial_frames.LINE_LENGTH), np.zeros(4096, np.uint8)
    for at in range(0, min(len(data), 1 << 16), 1024):
        place = serial_frames.make_room(line, buffer)
        piece = np.frombuffer(data[at : at + 1024], np.uint8)
        buffer[place : place + len(piece)] = piece
        line[serial_frames.END] = place + len(piece)
        while serial_frames.next_frame(line, buffer) >= 0:
            pass


def _serial_frame() -> bytes:
    frame = np.zeros(128, np.uint8)
    return frame[: serial_frames.seal_frame(frame, 1, 0, 0, 8)].tobytes()


def _machine(data: bytes) -> None:
    text, at = np.frombuffer(data[:4096], np.uint8), 0
    while at < len(text):
        _, at = take_answer(text, at, len(text), np.zeros(3))


def _vrpn(data: bytes) -> None:
    for message in MessageReader().feed(data):
        assert message.text is not None and message.pose != ()


_OSC = b"/pose/head\0\0,fffffff" + bytes(4) + struct.pack(">7f", 0, 1, 0, 0, 0, 0, 1)
_MIRROR = MirrorFrame(
    1, 2, np.zeros(1, np.uint32), np.zeros((1, 3), np.float32), np.array([[0, 0, 0, 1]], np.float32),
    np.ones((1, 3), np.float32), np.ones(1, np.uint8),
)  # fmt: skip

WIRES: dict[str, Reader] = {
    "serial robot and Lokomat": Reader("", _serial_frame(), _serial),
    "HapticMaster": Reader("", b"(0.1,0.2,0.3);0.5;--- no such;", _machine),
    "OSC": Reader("", _OSC, lambda data: list(read_datagram(data))),
    "VRPN": Reader("", COOKIE + announcement(-1, "head") + pack(0, 1, pose_body(0, (0, 1, 0), (0, 0, 0, 1)), 5), _vrpn),
    "Fastrak": Reader(
        "", fastrak_record(1, (0, 0.1, 0.2), (10, 5, 0), 0.0254), lambda data: FastrakParser(0.0254).feed(data, 1)
    ),
    "Flock": Reader("", flock_record((0, 0.1, 0.2), (10, 5, 0)), lambda data: FlockParser().feed(data, 1)),
    "amplifier": Reader("", b"rate 500 ecg\n1 0.5\n", lambda data: AmplifierReader().feed(data)),
    "vibrators": Reader("", bytes(6), lambda data: read_answers(bytearray(data))),
    "LSL markers": Reader("", b'{"command": "pause"}', lambda data: command_of_marker(data.decode("utf-8", "replace"))),
    "command of the page": Reader("", b'{"command": "pause"}', read_command),
    "request of the page": Reader("", b'{"id": 1, "ask": "operate"}', _ASKS.decode),
    "mirror": Reader("", write_frame(_MIRROR), read_frame),
}
"""What arrives at a wire, by its sender; a ValueError is how it is refused."""


def _bomb() -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a", bytes(1 << 26))
    return made.getvalue()


def _png(width: int, height: int) -> bytes:
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + b"IHDR" + head + struct.pack(">I", zlib.crc32(b"IHDR" + head))


def _told(data: bytes, text: str) -> bytes:
    """Every text and every name of a file replaced by another."""
    return re.sub(rb'"[^"]*"(?!\s*:)', json.dumps(text).encode(), data)


ATTACKS: Mapping[str, Callable[[bytes], bytes]] = {
    "as it is": lambda data: data,
    "nothing": lambda data: b"",
    "zeros": lambda data: bytes(4096),
    "ones": lambda data: b"\xff" * 4096,
    "a megabyte without a line's end": lambda data: b"A" * (1 << 20),
    "a hundred thousand lists": lambda data: b"[" * 100_000,
    "a hundred thousand objects": lambda data: b'{"a":' * 100_000,
    "a number of 10,000 digits": lambda data: re.sub(rb"\d+", b"9" * 10_000, data, count=1),
    "numbers beyond all": lambda data: re.sub(rb"\d+(\.\d+)?", b"1e999", data),
    "numbers that are none": lambda data: re.sub(rb"\d+(\.\d+)?", b"NaN", data),
    "counts of a billion": lambda data: re.sub(rb"\b\d+\b", b"1000000000", data),
    "negative numbers": lambda data: re.sub(rb"\b\d+\b", b"-1", data),
    "the first half": lambda data: data[: len(data) // 2],
    "all but the last byte": lambda data: data[:-1],
    "twice": lambda data: data + data,
    "other characters": lambda data: data.decode("latin-1").encode("utf-16"),
    "half a character": lambda data: data[:1] + b"\xed\xa0\x80" + data[1:],
    "the secret": lambda data: _told(data, "../secret.bin"),
    "a link to all": lambda data: _told(data, "/etc/passwd"),
    "a far address": lambda data: _told(data, "http://127.0.0.1:9/x"),
    "a share": lambda data: _told(data, "\\\\127.0.0.1\\x"),
    "an address of a file": lambda data: _told(data, "file:///etc/passwd"),
    "an order for a shell": lambda data: _told(data, "$(touch pwned); `touch pwned` | touch pwned"),
    "an expression": lambda data: _told(data, "__import__('os').system('touch pwned')"),
    "a format": lambda data: _told(data, "{0.__class__.__mro__} %n%s%n"),
    "a pickle": lambda data: b"cos\nsystem\n(S'touch pwned'\ntR.",
    "Python": lambda data: b"import os\nos.system('touch pwned')\n",
    "YAML": lambda data: b"!!python/object/apply:os.system ['touch pwned']\n",
    "XML that grows": lambda data: b'<!DOCTYPE a [<!ENTITY x "xxxxxxxxxx"><!ENTITY y "&x;&x;&x;">]><a>&y;</a>',
    "a bomb": lambda data: _bomb(),
    "a picture of a billion pixels": lambda data: _png(60_000, 60_000),
    "an executable": lambda data: b"\x7fELF" + bytes(200),
}
"""What an attacker makes of what a reader takes."""

_FORBIDDEN = ("socket.connect", "socket.bind", "socket.getaddrinfo", "urllib.Request", "subprocess.Popen", "os.system")
_FORBIDDEN += ("os.exec", "os.posix_spawn", "os.fork", "shutil.rmtree", "os.remove", "os.rename")
_NEVER_PICKLED = ("os", "posix", "nt", "subprocess", "shutil", "sys")
"""Modules that no cache of compiled kernels names."""
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT


class Watch:
    """Audit hook that forbids what no reader needs.

    Attributes:
        on: Whether a reader is at work.
        seen: What it did that it must not.
    """

    def __init__(self, outside: tuple[str, ...]) -> None:
        self.on, self.seen, self._outside = False, list[str](), outside
        sys.addaudithook(self)

    def __call__(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self.on:
            return
        unpickled = event == "pickle.find_class" and arguments[0] in _NEVER_PICKLED
        if event in _FORBIDDEN or unpickled:
            self.seen.append(f"{event} {arguments!r:.80}")
        elif event == "open" and not isinstance(arguments[0], int):
            name = os.fsdecode(arguments[0])
            if name.endswith(self._outside) or (arguments[2] or 0) & _WRITES:
                self.seen.append(f"opened {name}")


def happened(reader: Reader, subject: object, watch: Watch) -> dict[str, Any]:
    """Return what a reader did: how it ended, its time on the processor [s], and what it must not do."""
    watch.seen.clear()
    begun, ended = time.process_time(), "read"
    watch.on = True
    try:
        reader.read(subject)
    except Exception as error:  # noqa: BLE001  those that are no refusal are what is looked for
        refused = isinstance(error, MimicsError if reader.suffix else (MimicsError, ValueError, msgspec.DecodeError))
        ended = f"{'refused' if refused else 'raised'} {type(error).__name__}: {error!s:.120}"
    finally:
        watch.on = False
    return {"ended": ended, "seconds": time.process_time() - begun, "seen": list(watch.seen)}


def _subjects(name: str, reader: Reader, folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield the attacks by a file, each in a folder of its own, and those by what is no file."""
    for number, (attack, spoil) in enumerate(ATTACKS.items()):
        path = _place(folder, f"{name}_{number}", reader.suffix)
        path.write_bytes(spoil(reader.original))
        yield attack, path
    for attack, make in _NO_FILES.items():
        path = _place(folder, f"{name}_{attack}", reader.suffix)
        make(path)
        yield attack, path


def _place(folder: Path, name: str, suffix: str) -> Path:
    path = folder / "inside" / name.replace(" ", "_") / (suffix if "." in suffix[1:] else f"file{suffix}")
    path.parent.mkdir(parents=True)
    return path


_NO_FILES: dict[str, Callable[[Path], object]] = {
    "no file": lambda path: None,
    "a folder": lambda path: path.mkdir(),
    "a pipe": lambda path: os.mkfifo(path),
    "an endless device": lambda path: path.symlink_to("/dev/zero"),
    "a link to itself": lambda path: path.symlink_to(path),
}


def main(folder: Path) -> dict[str, Any]:
    """Attack every reader and every wire; return what each did, and the most memory [MB]."""
    (folder / "inside").mkdir()
    (folder / "secret.bin").write_bytes(SECRET)
    watch = Watch(("secret.bin", "/etc/passwd"))
    found: dict[str, Any] = {}
    for name, reader in READERS.items():
        path = _place(folder, f"{name}_first", reader.suffix)
        path.write_bytes(reader.original)
        happened(reader, path, watch)  # what is compiled and imported first takes its own time
        for attack, path in _subjects(name, reader, folder):
            found[f"{name}: {attack}"] = happened(reader, path, watch)
    for name, wire in WIRES.items():
        happened(wire, wire.original, watch)
        for attack, spoil in ATTACKS.items():
            found[f"{name}: {attack}"] = happened(wire, spoil(wire.original), watch)
    status = Path("/proc/self/status").read_text()
    peak = re.search(r"VmHWM:\s*(\d+)", status)
    return {
        "attacks": found,
        "peak_mb": int(peak[1]) // 1024 if peak else 0,
        "left": [str(p) for p in folder.rglob("pwned")],
    }


if __name__ == "__main__":
    print(json.dumps(main(Path(sys.argv[1]))))
