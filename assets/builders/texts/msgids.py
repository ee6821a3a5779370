"""Texts that are to be translated, from where they are written: the code, scenes, templates, the operator's page."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

from mimics_app import console
from mimics_app.contracts.loop.device_faults import FAULT_WORDS
from mimics_app.contracts.loop.haptic import SafetyState, TripCause
from mimics_app.contracts.messages.calibration_record import DIRECTIONS
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.contracts.system import resources
from mimics_app.recording.report_tables import caption_of
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.descriptors.leg import LEG, LEGS
from mimics_app.tasks.kinds.calibration.spec import STEPS
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.outcome_words import loss_captions
from mimics_app.tasks.prompt import cause_words
from mimics_app.tasks.task import MEASURES

__all__ = ["Msgid", "find_msgids", "page_texts"]


# Texts of the operator's page, from its own files: what an element with `data-text` holds, what a script gives to `t`
# or `mark`, and what the page is sent.
_FOLDER = Path(console.__file__).parent

_IN_SCRIPT = re.compile(r'\b(?:t|mark)\(\s*("(?:[^"\\]|\\.)*")')
_FROM_SESSION = (
    "The session is over.",
    "The application is gone: it crashed or was killed. Its recording can be repaired: mimics record recover.",
    "finished", "timeout", "aborted", "from the left", "from the right", "from above",
)  # fmt: skip
"""Texts that the page is sent and shows in the reader's language."""


def page_texts() -> dict[str, list[str]]:
    """Return the texts, each with the files that have it, in the order of the files."""
    found: dict[str, list[str]] = {}
    for file in sorted(_FOLDER.glob("page/*.html")) + sorted(_FOLDER.glob("page/*.js")):
        source, place = file.read_text(encoding="utf-8"), file.relative_to(_FOLDER).as_posix()
        for text in {".html": _in_html, ".js": _in_script}[file.suffix](source):
            places = found.setdefault(text, [])
            if place not in places:
                places.append(place)
    for text in (*FAULT_WORDS.values(), *_FROM_SESSION):
        found.setdefault(text, []).append("session")
    return found


class _Marked(HTMLParser):
    """Collects what the elements with `data-text` hold."""

    def __init__(self) -> None:
        super().__init__()
        self.texts: list[str] = []
        self._inside = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside = any(name == "data-text" for name, _ in attrs)

    def handle_endtag(self, tag: str) -> None:
        self._inside = False

    def handle_data(self, data: str) -> None:
        if self._inside and data.strip():
            self.texts.append(data)


def _in_html(source: str) -> list[str]:
    parser = _Marked()
    parser.feed(source)
    return parser.texts


def _in_script(source: str) -> list[str]:
    return [str(json.loads(quoted)) for quoted in _IN_SCRIPT.findall(source)]


_CODE = Path(__file__).resolve().parents[3] / "mimics_app"
_IN_TEMPLATE = re.compile(r'translated\("((?:[^"\\]|\\.)*)"\)')
_COLUMNS = (
    *("trial", "attempt", "block", "label", "practice", "outcome", "cause", "score", "time_s", "contacts", "progress"),
    *("path_error_max_m", "force_mean_n", "force_peak_n", "happened", "lost", "yes", "no"),
)
"""Columns of trials.csv that every task has, and words in them."""
_IN_SCENE = ("title", "description", "instructions", "prompt")
"""Members of a scene, and of its task, that a person reads."""


@dataclass
class Msgid:
    """A text to be translated.

    Attributes:
        text: The English text.
        plural: The same for other numbers than 1, "" without plural forms.
        places: Where it is written.
    """

    text: str
    plural: str = ""
    places: list[str] = field(default_factory=list)


def find_msgids() -> list[Msgid]:
    """Return all texts, each once, sorted by their first place and then by the text."""
    found: dict[str, Msgid] = {}
    for text, plural, place in (*_in_code(), *_in_templates(), *_in_scenes(), *_in_sets(), *_in_page()):
        known = found.setdefault(text, Msgid(text, plural))
        if place not in known.places:
            known.places.append(place)
    return sorted(found.values(), key=lambda each: (each.places[0], each.text))


def _in_code() -> Iterator[tuple[str, str, str]]:
    """Yield what is given to `phrase` and `counted_phrase`."""
    for file in sorted(_CODE.rglob("*.py")):
        source = file.read_text(encoding="utf-8")
        if "phrase(" not in source:
            continue
        place = file.relative_to(_CODE.parent).as_posix()
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                if node.func.id == "phrase":
                    yield from ((text, "", place) for text in _literals(node.args[0]))
                elif node.func.id == "counted_phrase":
                    (one,), (many,) = _literals(node.args[0]), _literals(node.args[1])
                    yield one, many, place


def _literals(given: ast.expr) -> list[str]:
    """Return a literal, or those between which a condition chooses."""
    choices = [given.body, given.orelse] if isinstance(given, ast.IfExp) else [given]
    return [each.value for each in choices if isinstance(each, ast.Constant) and isinstance(each.value, str)]


def _in_templates() -> Iterator[tuple[str, str, str]]:
    for file in sorted(_CODE.rglob("*.j2")):
        for text in _IN_TEMPLATE.findall(file.read_text(encoding="utf-8")):
            yield text, "", file.relative_to(_CODE.parent).as_posix()


def _in_scenes() -> Iterator[tuple[str, str, str]]:
    root = resources.root()
    for file in sorted((root / "scenes").rglob("*.json")):
        for text in _read_scene(json.loads(file.read_text(encoding="utf-8"))):
            for line in text.split("\n"):
                yield line, "", file.relative_to(root).as_posix()


def _read_scene(document: Mapping[str, Any]) -> Iterator[str]:
    task = document.get("task") or {}
    yield from (part[name] for part in (document, task) for name in _IN_SCENE if part.get(name))
    yield from (text for text in task.get("messages", {}).values() if text)
    yield from (each["instructions"] for each in task.get("devices", {}).values() if each.get("instructions"))
    for trigger in task.get("triggers", ()):
        yield from (deed["text"] for deed in trigger.get("do", ()) if "text" in deed)
    for entity in (*document.get("entities", ()), *document.get("prefabs", {}).values()):
        billboard = entity.get("components", {}).get("billboard", {})
        yield from (billboard[name] for name in ("text",) if billboard.get(name))
    cord = task.get("avatar_cord") or {}
    yield from (item["text"] for item in (cord.get("questionnaire") or {}).get("items", ()))
    if "carry" in task:
        yield task["carry"]["body"].replace("_", " ")


def _in_sets() -> Iterator[tuple[str, str, str]]:
    """Yield the members of closed sets, whose words are those of the code."""
    causes = [cause_words(int(cause)) for cause in TripCause if cause != TripCause.NONE]
    yield from ((text, "", "causes of stops") for text in causes)
    yield from ((state.value, "", "states of a trial") for state in TrialState)
    yield from ((text, "", "parts of a score") for text in loss_captions())
    yield from ((text, "", "steps of a calibration") for step in STEPS for text in (step, step.capitalize()))
    yield from ((text, "", "directions of a calibration") for text in DIRECTIONS)
    measures = (*MEASURES, *(measure for kind in task_kinds() for measure in kind.measures))
    columns = [*_COLUMNS, *(measure.column for measure in measures)]
    yield from ((caption_of(column, {}), "", "columns of trials") for column in columns)
    yield from ((state.name.replace("_", " ").lower(), "", "states of the loop") for state in SafetyState)
    limbs = [limb for descriptor in (HAPTICMASTER, LEG, LEGS) for limb in descriptor.contacts]
    yield from ((text, "", "points of contact") for text in limbs)


def _in_page() -> Iterator[tuple[str, str, str]]:
    for text, places in page_texts().items():
        yield from ((text, "", f"console/{place}") for place in places)
