"""The stub of record types, made from the dtypes: `python -m tests.architecture.record_stub` writes it anew."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["STUB", "STUBS", "stub_text"]

ROOT = Path(__file__).resolve().parents[2]
STUB = ROOT / "mimics_app" / "rendering" / "haptic" / "record_types.pyi"
"""What it is written to."""

_HAPTIC = "mimics_app.rendering.haptic.kernels"
_LOKOMAT = "mimics_app.rendering.haptic.control.lokomat"

MODULES = (
    "mimics_app.contracts.loop.haptic_objects",
    "mimics_app.contracts.loop.haptic",
    "mimics_app.contracts.loop.contact_force",
    "mimics_app.contracts.loop.reference_rows",
    "mimics_app.rendering.haptic.reference.generator",
    "mimics_app.rendering.haptic.reference.cycle_curves",
    "mimics_app.rendering.haptic.reference.generator",
    "mimics_app.contracts.loop.controller_port",
    f"{_HAPTIC}.contact_records",
    f"{_HAPTIC}.objects.records",
    f"{_HAPTIC}.objects.contact_scratch",
    f"{_HAPTIC}.objects.totals",
    f"{_HAPTIC}.objects.touches",
    f"{_HAPTIC}.closed_region",
    f"{_HAPTIC}.directions",
    f"{_HAPTIC}.oscillation",
    f"{_HAPTIC}.passivity",
    f"{_HAPTIC}.acting",
    f"{_HAPTIC}.controller_slot",
    f"{_HAPTIC}.state",
    f"{_LOKOMAT}.obstacle_sequence",
    f"{_LOKOMAT}.sagittal_outline",
    f"{_LOKOMAT}.foot_constraint",
    f"{_LOKOMAT}.contact_impulse",
    f"{_LOKOMAT}.foot_contact",
    f"{_LOKOMAT}.shaft_admittance",
    f"{_LOKOMAT}.constrained_shafts",
    f"{_LOKOMAT}.position_control",
    f"{_LOKOMAT}.guidance_force",
    f"{_LOKOMAT}.encoder_speed",
    f"{_LOKOMAT}.leg_control",
    f"{_LOKOMAT}.gait_limits",
    f"{_LOKOMAT}.heel_strike",
    f"{_LOKOMAT}.encoder_watch",
    f"{_LOKOMAT}.sensor_watch",
    "mimics_app.rendering.haptic.controllers.orthosis_walk",
)
"""Where records of touch are declared: every dtype with fields that a module of these names in capitals."""

_DSP = "mimics_app.dsp.kernels"

SIGNAL_STUB = ROOT / "mimics_app" / "dsp" / "record_types.pyi"
SIGNAL_MODULES = (f"{_DSP}.rhythm", f"{_DSP}.ecg", f"{_DSP}.beat_path", f"{_DSP}.beats", f"{_DSP}.slow", f"{_DSP}.emg")
"""The same for the processing of body signals."""

_INTRO = '''"""Types of the records that compiled functions take, for type checkers: there is no module at run time.

One class for each numpy record dtype, with the Python type of each field; what a field is stands at the dtype. It is
written by `python -m tests.architecture.record_stub`, and a test holds it against the dtypes. Kernels import from here
under `TYPE_CHECKING` only: the cache of machine code, which is keyed by the sources a kernel reaches, does not look
at a stub, so no kernel is tied to every record.
"""
'''

_TABLE = '''
class Table(Protocol[R]):
    """An array of records."""

    @property
    def shape(self) -> tuple[int, ...]: ...
    @property
    def size(self) -> int: ...
    def __len__(self) -> int: ...
    def __getitem__(self, index: int, /) -> R: ...
    def __setitem__(self, index: int, value: R, /) -> None: ...
'''

_DESCRIPTION = '''
class Description(Protocol):
    """A record that describes a device for its kinematics."""

    joints: int
    contacts: int
    geometry: Floats
'''

_SIGNAL_HEAD = f"""{_INTRO}
from typing import Protocol, TypeVar

R = TypeVar("R")
{_TABLE}"""

_HEAD = f"""{_INTRO}
from collections.abc import Callable
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.device_descriptor import Kin as Kin
from mimics_app.contracts.loop.object_rows import Rows as Rows
from mimics_app.rendering.haptic.channels import Channels as Channels
from mimics_app.rendering.haptic.channels import Work as Work
from mimics_app.rendering.haptic.mesh_table import MeshTable as MeshTable
from mimics_app.rendering.haptic.objects import ObjectWork as ObjectWork
from mimics_app.rendering.haptic.ridge_table import RidgeTable as RidgeTable

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]
Ints = NDArray[np.int64]
Ints32 = NDArray[np.int32]
Ints16 = NDArray[np.int16]
Ints8 = NDArray[np.int8]
Bytes = NDArray[np.uint8]

R = TypeVar("R")

{_TABLE.strip()}

{_DESCRIPTION.strip()}

Read = Callable[[Floats, Floats, Floats, int], int]
Write = Callable[[Floats, Floats, int], int]
Field = Callable[[Floats, Floats, Floats, float, Floats], None]
Fields = tuple[Field, ...]
Controller = Callable[[Kin, ControlInputRecord, Floats, Floats, ControlWorkRecord, ControlOutputRecord], None]
Controllers = tuple[Controller, ...]
Simulate = Callable[[Rows, ObjectWork, ObjectCountsRecord, Floats, Fields, float, Floats], None]
Tick = Callable[
    [
        SceneRecord,
        Rows,
        ObjectWork,
        Simulate,
        Fields,
        Kin,
        Table[StateRecord],
        Floats,
        int,
        int,
        int,
        float,
        float,
        Floats,
        SampleRecord,
    ],
    None,
]
LoopTick = Callable[
    [Channels, Work, Tick, Read, Write, Floats, Simulate, Fields, Kin, int, int, float, int, float], int
]
"""

_ARRAYS = {"f8": "Floats", "f4": "Floats32", "i8": "Ints", "i4": "Ints32", "i2": "Ints16", "i1": "Ints8", "u1": "Bytes"}


STUBS = {STUB: (MODULES, _HEAD), SIGNAL_STUB: (SIGNAL_MODULES, _SIGNAL_HEAD)}
"""Modules and head of each stub, by its file."""


def _records(modules: tuple[str, ...]) -> Iterator[tuple[str, str, np.dtype[Any]]]:
    """(module, name, dtype) of every record, each once, where it is declared first."""
    seen: list[np.dtype[Any]] = []
    for module in modules:
        for name, dtype in vars(import_module(module)).items():
            if isinstance(dtype, np.dtype) and dtype.names and dtype not in seen:
                seen.append(dtype)
                yield module, name, dtype


def _class(name: str) -> str:
    return "".join(word.capitalize() for word in name.split("_")) + "Record"


def _annotation(dtype: np.dtype[Any], classes: dict[np.dtype[Any], str]) -> str:
    if dtype.subdtype:
        base = dtype.subdtype[0]
        return f"Table[{classes[base]}]" if base.names else _ARRAYS[f"{base.kind}{base.itemsize}"]
    return classes[dtype] if dtype.names else "float" if dtype.kind == "f" else "int"


def stub_text(stub: Path) -> str:
    """A stub as the dtypes are now."""
    modules, head = STUBS[stub]
    records = list(_records(modules))
    classes = {dtype: _class(name) for _, name, dtype in records}
    parts = [head]
    for module, name, dtype in records:
        fields = [f"    {field}: {_annotation(dtype[field], classes)}" for field in dtype.names or ()]
        parts.append("\n".join([f"class {classes[dtype]}:", f'    """`{module}.{name}`."""', "", *fields, ""]))
    return "\n".join(parts)


if __name__ == "__main__":
    for each in STUBS:
        each.write_text(stub_text(each), encoding="utf-8")
        sys.stdout.write(f"{each.relative_to(ROOT)}\n")
