"""Names of channels and columns that stand for a body signal: an exact list, so that none is taken by mistake.

A name is a kind of signal, alone or with words that say where or how it was measured: "ECG II", "EDA_Raw".
With any other word it is something else: "ECG_Quality", "skin temperature", "respiration rate", "lead_off".
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from mimics_app.contracts.errors import short_text

__all__ = ["NAMES_HINT", "columns_of", "say_columns", "signal_of", "split_unit", "unit_factor"]

NAMES_HINT = (
    "name them ecg, gsr, emg or resp, with a lead, a muscle or a number if there are several; "
    "also EKG, I, II, III, V1 to V6, MLII, EDA, skin conductance, RSP, respiration and breathing are known"
)
"""What to do where no channel has a known name."""

_LEADS = {"i", "ii", "iii", *(f"v{n}" for n in range(1, 7)), "avr", "avl", "avf", "mli", "mlii", "mliii"}
_HOW = set("raw clean cleaned filtered cal uncal signal channel ch bit left right mv uv us".split())
_KINDS: dict[str, tuple[set[str], set[str]]] = {
    "ecg": ({"ecg", "ekg"}, {*_LEADS, "lead", "ra", "la", "rl", "ll", "vx"}),
    "gsr": (
        {"gsr", "eda", "sc", "scl", "conductance"},
        set("skin level gsr eda conductance finger hand palm foot".split()),
    ),
    "emg": (
        {"emg"},
        set(
            "biceps triceps brachii deltoid deltoideus trapezius pectoralis forearm flexor extensor carpi digitorum "
            "brachioradialis pronator masseter corrugator zygomaticus chin tibialis anterior posterior tib ant "
            "gastrocnemius soleus quadriceps rectus femoris vastus lateralis medialis hamstrings gluteus arm leg hand "
            "upper lower medial lateral".split()
        ),
    ),
    "resp": (
        {"resp", "rsp", "respiration", "breath", "breathing", "thorax", "abdomen", "chest"},
        set("belt thorax abdomen chest thoracic abdominal nasal effort".split()),
    ),
}
"""First word of each kind of signal, and the words that may follow it."""
_ALONE = {
    **dict.fromkeys(_LEADS, "ecg"),
    **{f"lead {lead}": "ecg" for lead in _LEADS},
    "skin conductance": "gsr",
    "skin conductance level": "gsr",
    "electrodermal activity": "gsr",
    "galvanic skin response": "gsr",
    "electrocardiogram": "ecg",
    "electromyogram": "emg",
}
"""Whole names."""

_BRACKETS = re.compile(r"^(.*?)\s*[(\[]([^)\]]*)[)\]]\s*$")
_UNIT = re.compile(r"(|milli|micro|nano|[mun])(v|volts?|s|siemens)")
_PREFIXES = {"": 1.0, "m": 1e-3, "milli": 1e-3, "u": 1e-6, "micro": 1e-6, "n": 1e-9, "nano": 1e-9}
_PER_BASE = {"ecg": ("v", 1e3), "emg": ("v", 1e3), "gsr": ("s", 1e6)}
"""First letter of the units of a signal, and its own units per volt or siemens."""
_MOST_SAID = 12
"""Largest number of columns named in a note."""


def signal_of(label: str) -> str:
    """Return the body signal that a label stands for: "ecg", "gsr", "emg" or "resp"; "" for none."""
    plain, unit = split_unit(label)
    words = re.sub(r"[^a-z0-9]+", " ", plain.lower()).split()
    if not words or "ohm" in unit.lower():
        return ""
    if found := _ALONE.get(" ".join(words)):
        return found
    words = [re.sub(r"^([a-z]{2,})\d+$", r"\1", word) if word not in _LEADS else word for word in words]
    for name, (kinds, more) in _KINDS.items():
        if words[0] in kinds and all(word.isdigit() or word in more or word in _HOW for word in _rest(words)):
            return name
    return ""


def _rest(words: Sequence[str]) -> list[str]:
    """Return the words after the first, without the digits of "24bit"."""
    return [word.lstrip("0123456789") or word for word in words[1:]]


def columns_of(labels: Iterable[str]) -> dict[str, int]:
    """Return the number of the first channel of each body signal, by the labels of the channels."""
    columns: dict[str, int] = {}
    for i, label in enumerate(labels):
        if name := signal_of(label):
            columns.setdefault(name, i)
    return columns


def say_columns(labels: Sequence[str], columns: dict[str, int], known: Iterable[int] = ()) -> tuple[str, ...]:
    """Return in words which columns are read, and which are not.

    Args:
        labels: All labels.
        columns: Column of each body signal.
        known: Further columns that are read, as those of the time.
    """
    read = ", ".join(f'{name} from "{short_text(labels[i])}"' for name, i in columns.items())
    left = [label for i, label in enumerate(labels) if i not in {*columns.values(), *known}]
    named = ", ".join(f'"{short_text(label)}"' for label in left[:_MOST_SAID])
    more = f" and {len(left) - _MOST_SAID} more" if len(left) > _MOST_SAID else ""
    return (f"read: {read}", *((f"not read: {named}{more}",) if left else ()))


def split_unit(label: str) -> tuple[str, str]:
    """Return a label without the unit in brackets at its end, and the unit; "" without one."""
    found = _BRACKETS.match(label)
    return (found[1].strip(), found[2].strip()) if found else (label.strip(), "")


def unit_factor(name: str, unit: str) -> float:
    """Return the factor from a stated unit to that of a body signal, e.g. 1e-3 for "uV" and "ecg".

    1 where the unit is empty or not one of voltage or conductance: the values are then taken as they are.
    """
    base, per_base = _PER_BASE.get(name, ("", 1.0))
    match = _UNIT.fullmatch(unit.strip().lower().replace("\u00b5", "u").replace("\u03bc", "u"))
    return per_base * _PREFIXES[match[1]] if match and match[2][0] == base else 1.0
