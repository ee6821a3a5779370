"""Forms of a participant of a study before a session: shown and answered by `mimics study`, which keeps the answers."""

from __future__ import annotations

import unicodedata
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from mimics_app.console.clients import ASK_FIRST, VIEWS, Client
from mimics_app.console.command_line import ask_command
from mimics_app.console.readiness import StudyName, Word
from mimics_app.contracts.system.phrases import phrase

__all__ = ["FormRequest", "answer_of_form", "why_no_form"]

_Code = Annotated[str, Meta(min_length=1, max_length=120, pattern=r"^[^\x00-\x1f\ud800-\udfff]*$")]
_Value = Annotated[str, Meta(max_length=2000)]


class FormRequest(msgspec.Struct, forbid_unknown_fields=True):
    """What the operator wants of the forms of a participant.

    Attributes:
        study: Folder of a study in the folder of the page.
        participant: Code of the person.
        form: Name of the form; "": the list of them.
        add: Whether the operator has confirmed that a new code is to be added to the study.
        answers: Values by item as they were typed, which are kept; None: the form is shown.
    """

    study: Annotated[StudyName, Meta(min_length=1)]
    participant: _Code
    form: Word = ""
    add: bool = False
    answers: Annotated[dict[Word, _Value], Meta(max_length=200)] | None = None


def why_no_form(client: Client, wanted: FormRequest | None) -> str:
    """Return why a page gets no form: only the one that operates sees and gives answers; "" where it does."""
    if not client.may_operate:
        return VIEWS
    if not client.operates:
        return ASK_FIRST
    return "nothing was chosen" if wanted is None else ""


async def answer_of_form(wanted: FormRequest) -> dict[str, Any]:
    """Return the list of the forms, a form, or what became of answers.

    Keys: `done` and `why` always; of a list `forms`, titles by name, and `known`, whether the study has the code; of a
    form `form`, the object of `mimics study form --json`; of answers that are refused `faults`, by JSON pointer.
    """
    if not wanted.form:
        return _list_of(wanted, await ask_command("study", "--", "status", wanted.study))
    options = [] if wanted.add else ["--known"]
    given = b""
    if wanted.answers is not None:
        options.append("--answers=-")
        given = msgspec.json.encode(wanted.answers)
    words = ["--", "form", wanted.study, wanted.participant, wanted.form]
    found = await ask_command("study", *options, *words, given=given)
    faults = {each["pointer"]: each["what"] for each in found.get("errors", []) if each.get("pointer")}
    why = _why(found, "form")
    return {"done": not why, "why": why, **({"faults": faults} if why else {"form": found})}


def _list_of(wanted: FormRequest, status: dict[str, Any]) -> dict[str, Any]:
    why = _why(status, "forms")
    code = unicodedata.normalize("NFC", wanted.participant).strip()
    known = any(each.get("participant") == code for each in status.get("participants", []))
    return {"done": not why, "why": why, "forms": status.get("forms", {}), "known": known}


def _why(found: dict[str, Any], key: str) -> str:
    """Return why a command has not done what it was asked for, with the remedy; "" where it has: the key is there."""
    if key in found:
        return ""
    first = next(iter(found.get("errors", [])), {"what": phrase("no answer")})
    return " · ".join(str(first[each]) for each in ("what", "fix") if first.get(each))
