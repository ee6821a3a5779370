"""Types of the records that compiled functions take, for type checkers: there is no module at run time.

One class for each numpy record dtype, with the Python type of each field; what a field is stands at the dtype. It is
written by `python -m tests.architecture.record_stub`, and a test holds it against the dtypes. Kernels import from here
under `TYPE_CHECKING` only: the cache of machine code, which is keyed by the sources a kernel reaches, does not look
at a stub, so no kernel is tied to every record.
"""

from typing import Protocol, TypeVar

R = TypeVar("R")

class Table(Protocol[R]):
    """An array of records."""

    @property
    def shape(self) -> tuple[int, ...]: ...
    @property
    def size(self) -> int: ...
    def __len__(self) -> int: ...
    def __getitem__(self, index: int, /) -> R: ...
    def __setitem__(self, index: int, value: R, /) -> None: ...

class RhythmRecord:
    """`mimics_app.dsp.kernels.rhythm.RHYTHM`."""

    last: float
    rr: float
    phase: float
    unsteady: float

class EnergyStateRecord:
    """`mimics_app.dsp.kernels.ecg.ENERGY_STATE`."""

    rhythm: RhythmRecord
    signal_level: float
    noise_level: float
    candidate_at: float
    candidate: float
    squares: float
    back_at: float
    back: float
    n: float
    held: float
    missing: float
    learnt: float
    kept: float
    low2: float
    low4: float
    high2: float
    high4: float
    upper: float
    begin: float
    found: float
    same: float
    far: float
    far_at: float
    pairs: float
    paired: float
    last_beat: float
    waiting_at: float
    waiting: float

class PathRecord:
    """`mimics_app.dsp.kernels.beat_path.PATH`."""

    evidence: float
    period: float
    latest: float
    beats: float
    deviation: float

class FormStateRecord:
    """`mimics_app.dsp.kernels.beats.FORM_STATE`."""

    rhythm: RhythmRecord
    matched: float
    candidate_at: float
    candidate: float
    back_at: float
    back: float
    n: float
    share: float
    energy_at: float
    energy: float
    variance: float
    noise_count: float
    fitted: float
    provisional: float
    searched: float
    proven: float
    written: float
    reliable: float
    early: float

class TurnStateRecord:
    """`mimics_app.dsp.kernels.slow.TURN_STATE`."""

    n: float
    rising: float
    low: float
    low_at: float
    high: float
    high_at: float
    size: float
    held: float
    missing: float
    last_at: float
    mark: float
    mark_at: float
    rose: float

class EmgStateRecord:
    """`mimics_app.dsp.kernels.emg.EMG_STATE`."""

    n: float
    squares: float
    base: float
    spread: float
    above: float
    active: float
    below: float
    held: float
    since: float
    total: float
    learnt: float
