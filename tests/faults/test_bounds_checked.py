"""Bounds checks: a run of the loop with them finds nothing, and they do find a planted index out of range.

numba's cache does not know about NUMBA_BOUNDSCHECK; ours does, by the name of its folder.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from mimics_app.compiled.cache_folder import cache_folder

ROOT = Path(__file__).parents[2]

PLANTED = """
import numpy as np
from mimics_app.compiled.kernel import kernel

@kernel
def planted(a, i):
    return a[i]

print(planted(np.zeros(3), 3))
"""

RUN = """
import gc
gc.set_threshold(50_000, 20, 20)  # a compiler makes millions of objects that are no rubbish yet
import numpy as np
from mimics_app.contracts.loop.controller_slots import Slot
from tests.support.haptic_bench import patient_bench
bench = patient_bench("severe", 3)
samples = bench.advance(2200)
bench.publish(controller=Slot.PERSON, trial=1)
bench.send(active=1, trial=1)
samples = np.concatenate([samples, bench.advance(8000)])
bench.replay(samples)
print(int((samples["penetration"] > 0).sum()))
"""


def _checked_cache() -> Path | None:
    """A folder beside the ordinary one, kept from run to run: compiling the loop with checks takes half a minute."""
    return None if cache_folder is None else cache_folder.parent / "bounds-checked"


def _child(text: str, folder: Path) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {
        "NUMBA_BOUNDSCHECK": "1",
        "NUMBA_CACHE_DIR": str(_checked_cache() or folder),
        "PYTHONPATH": str(ROOT),
    }
    script = folder / "child.py"
    script.write_text(text)
    command = [sys.executable, str(script)]
    return subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True, timeout=400, check=False)


def test_planted_index_is_caught(tmp_path: Path):
    done = _child(PLANTED, tmp_path)
    assert done.returncode != 0 and "IndexError" in done.stderr


def test_a_run_of_the_whole_loop_stays_in_bounds(tmp_path: Path):
    done = _child(RUN, tmp_path)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 100
