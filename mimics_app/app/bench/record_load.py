"""The session that `mimics bench record` kills: live, with recorder and simulated person, in a process of its own."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from mimics_app.app.session.assembly import build_session, start_loop
from mimics_app.app.session.frame import Frames
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import FRAMES_PER_SECOND, SECOND_NS
from mimics_app.rendering.haptic.devices.device_names import SIMULATED

__all__ = ["main"]


def main(scene: Path, runs: Path) -> None:
    """Play a scene until the process is killed.

    The first line on stdout has the descriptor of the session's memory, the recorder's process and the run folder; each
    further one the number of trials passed to the recorder so far.
    """
    with build_session(RunSettings(scene, device=SIMULATED, sound="off", runs=runs), live=True) as session:
        start_loop(session)
        frames, trials = Frames(session), 0
        facts = {"memory": session.memory.segment.descriptor, "recorder": session.recorder.pid}
        print(json.dumps({**facts, "folder": str(session.recorder.folder)}), flush=True)
        due_ns = session.clock.now_ns()
        while True:
            frames.step()
            if len(session.tasks.rows) > trials:
                trials = len(session.tasks.rows)
                print(trials, flush=True)
            due_ns += SECOND_NS // FRAMES_PER_SECOND
            session.clock.sleep_until_ns(due_ns)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
