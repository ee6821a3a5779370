"""Protocol of a study, study.json: conditions, blocks and their order, sessions; and the plan of one session."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path
from typing import Annotated

import msgspec
from msgspec import Meta

from mimics_app.app.scenes.scene_search import find_scene
from mimics_app.app.settings import DIFFICULTIES
from mimics_app.app.study.counterbalance import Order, order_of
from mimics_app.app.study.forms import Form
from mimics_app.contracts.errors import Issue, SceneError, first_line
from mimics_app.contracts.messages.fit import FitLimits
from mimics_app.contracts.system.phrases import phrase
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.recording.json_text import parse_object

__all__ = ["Block", "Condition", "PlannedRun", "Protocol", "plan_of", "read_protocol", "scene_of", "seed_of"]

_LARGEST = 1 << 20
"""Largest protocol [bytes]."""
_SEED_BITS = 31


class Condition(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """One condition: a scene with settings of `mimics run`.

    Attributes:
        scene: Scene file beside the protocol, or name of a shipped scene.
        difficulty: "easier", "usual" or "harder".
        trials: Number of trials that count, 0: as in the scene.
        options: Further options of `mimics run`, as on its command line.
    """

    scene: str
    difficulty: str = "usual"
    trials: Annotated[int, Meta(ge=0, le=10_000)] = 0
    options: list[str] = []


class Block(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """Conditions that follow each other in an order, some times.

    Attributes:
        conditions: Names of conditions.
        order: How their order is found for each participant.
        repeat: Number of times.
    """

    conditions: Annotated[list[str], Meta(min_length=1, max_length=100)]
    order: Order = "fixed"
    repeat: Annotated[int, Meta(ge=1, le=100)] = 1


class Protocol(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """Protocol of a study.

    Attributes:
        conditions: Conditions by name.
        blocks: Blocks of a session, in order.
        sessions: Number of sessions of each participant.
        seed: Seed of all orders and runs.
        title: Title for the reports.
        forms: Forms and questionnaires by name.
        fitting: How far the tasks are fitted to a calibration of the participant.
        format, version: Of the file.
    """

    conditions: dict[str, Condition]
    blocks: Annotated[list[Block], Meta(min_length=1)]
    sessions: Annotated[int, Meta(ge=1, le=1000)] = 1
    seed: int = 1
    title: str = ""
    forms: dict[str, Form] = {}
    fitting: FitLimits = FitLimits()
    format: str = "mimics study"
    version: Annotated[int, Meta(ge=1, le=1)] = 1


class PlannedRun(msgspec.Struct, frozen=True):
    """One run of a session's plan.

    Attributes:
        number: Place in the plan, 1 first.
        condition: Name of its condition.
        seed: Seed of the run.
    """

    number: int
    condition: str
    seed: int


def read_protocol(path: Path) -> Protocol:
    """Read and check a protocol.

    Raises:
        SceneError: It cannot be read, or names what there is not.
    """
    try:
        protocol = msgspec.convert(parse_object(read_regular(path, _LARGEST)), Protocol)
    except OSError as error:
        raise SceneError(Issue(str(path), "", phrase("cannot be read: {why}", why=error.strerror or error))) from error
    except (msgspec.ValidationError, ValueError) as error:
        what = phrase("is not a protocol of a study: {why}", why=first_line(error))
        raise SceneError(Issue(str(path), "", what, phrase("see docs/guide/studies.md"))) from error
    if faults := _faults(path, protocol):
        raise SceneError(faults)
    return protocol


def _faults(path: Path, protocol: Protocol) -> list[Issue]:
    found = []
    for i, block in enumerate(protocol.blocks):
        for name in block.conditions:
            if name not in protocol.conditions:
                known = ", ".join(protocol.conditions) or "none"
                found.append(
                    Issue(
                        str(path),
                        f"/blocks/{i}",
                        phrase('there is no condition "{condition}"', condition=name),
                        f"known: {known}",
                    )
                )
    for name, form in protocol.forms.items():
        for item, about in form.items.items():
            if about.fault:
                found.append(Issue(str(path), f"/forms/{name}/items/{item}", about.fault))
    for name, condition in protocol.conditions.items():
        if condition.difficulty not in DIFFICULTIES:
            known = ", ".join(DIFFICULTIES)
            what = f'there is no difficulty "{condition.difficulty}"'
            found.append(Issue(str(path), f"/conditions/{name}/difficulty", what, f"known: {known}"))
        try:
            scene_of(path, condition)
        except SceneError as error:
            found += [Issue(str(path), f"/conditions/{name}/scene", issue.what, issue.fix) for issue in error.issues]
    return found


def scene_of(protocol: Path, condition: Condition) -> Path:
    """Return the scene of a condition: a file beside the protocol, or one that `mimics run` finds.

    Raises:
        SceneError: There is none.
    """
    beside = protocol.parent / condition.scene
    return beside if os.path.isfile(beside) else find_scene(Path(condition.scene))


def seed_of(*parts: object) -> int:
    """Return a seed that depends on all parts, the same on every machine."""
    text = "\0".join(map(str, parts)).encode("utf-8", "surrogateescape")
    return int.from_bytes(hashlib.sha256(text).digest()[:8], "big") >> (64 - _SEED_BITS)


def plan_of(protocol: Protocol, participant: str, row: int, session: int) -> list[PlannedRun]:
    """Return the runs of a session in order.

    Args:
        protocol: The protocol.
        participant: Code of the participant.
        row: Number of the participant, 0 first: the row of the squares.
        session: Number of the session, 1 first.
    """
    names: list[str] = []
    for i, block in enumerate(protocol.blocks):
        for turn in range(block.repeat):
            seed = seed_of(protocol.seed, participant, session, i, turn)
            order = order_of(block.order, len(block.conditions), row + turn, seed)
            names += [block.conditions[k] for k in order]
    return [
        PlannedRun(number, name, seed_of(protocol.seed, participant, session, "run", number))
        for number, name in enumerate(names, start=1)
    ]
