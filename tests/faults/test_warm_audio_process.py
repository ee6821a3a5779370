"""Once an output is open, nothing is compiled or loaded any more: the first block in a room waited for a kernel."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

PROGRAM = """
import gc, sys
from pathlib import Path
import numpy as np
from numba.core.dispatcher import Dispatcher
from mimics_app.lab.groups.spatialiser import listener_amid
from mimics_app.contracts.clock import VirtualClock
from mimics_app.rendering.audio.engine import open_engine
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec

def loaded():
    return {each.py_func.__qualname__: len(each.overloads) for each in gc.get_objects() if isinstance(each, Dispatcher)}

sounds = {"hit": SoundSpec(recipe="cup"), "music": SoundSpec(recipe="goal", spatial=False)}
output = {"sink": "file", "file": Path(sys.argv[1]), "triggers": {}, "scrape": "", "mixer": "spectral"}
found = []
for layout in ({"hrtf": True}, {"hrtf": False, "speakers": "5.1"}):
    settings = AudioSettings(sounds=sounds, **output, **layout)
    engine = open_engine(settings, VirtualClock())
    mixer, before = engine.mixer, loaded()
    start = mixer.start("hit", 0, (0.3, 0.1, -1.0), 0.5)
    live = mixer.start("hit:live:0", 0, (0.3, 0.1, -1.0), 0.5)
    mixer.fill(live.handle, 0, np.ones(480, np.float32))
    mixer.start("music", 0, None, 0.5)
    state = listener_amid(np.array([start.handle]), np.array([[-0.3, 0.1, -1.0]]))
    state.pitch[:] = 1.3
    for level in (0.0, 0.5, 0.0):
        object.__setattr__(state, "room_level", level)
        mixer.set_listener(state)
        mixer.render(80)
    mixer.stop(start.handle)
    mixer.master(0.5)
    mixer.render(80)
    found += [name for name, count in loaded().items() if count != before.get(name)]
print(found)
"""


def test_no_kernel_is_loaded_while_sound_plays(tmp_path: Path) -> None:
    command = [sys.executable, "-c", PROGRAM, str(tmp_path / "mix.wav")]
    answer = subprocess.run(command, capture_output=True, text=True, check=True, timeout=240)
    assert answer.stdout.strip() == "[]"
