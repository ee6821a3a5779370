"""Stands in for the app in the sound tests that need a process of their own to be killed or listened to.

python -m tests.support.audio_app device FILE     opens a device, prints the status, closes
python -m tests.support.audio_app hold FILE       sound into FILE; prints the child's pid, then waits to be killed
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.rendering.audio.process import AudioProcess
from mimics_app.rendering.audio.settings import AudioSettings


def main(mode: str, file: Path) -> None:
    memory = SessionMemory()
    if mode == "device":
        audio = AudioProcess(memory, AudioSettings(sink="device", file=file, driver="wave"))
        audio.start()
        status = audio.wait_ready(60.0)
        report = audio.stop()
        print(json.dumps({"sink": status.sink, "notice": status.notice, "crashed": report.crashed}))
        return
    audio = AudioProcess(memory, AudioSettings(sink="file", file=file))
    audio.start()
    audio.wait_ready(60.0)
    print(audio.pid, flush=True)
    time.sleep(60.0)


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
