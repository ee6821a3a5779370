"""Forms and questionnaires of a study: items by schema, and answers checked by them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from mimics_app.contracts.errors import Issue, UsageError, nearest
from mimics_app.contracts.system.language import translated
from mimics_app.contracts.system.phrases import phrase
from mimics_app.world.files.reading.json_text import escape

__all__ = ["SHIPPED_FORMS", "Answer", "AnswersError", "Form", "Item", "check_answers", "item_words"]

Answer = str | float
"""Value of an item."""

_LONGEST = 2000
"""Longest text of an answer."""


class Item(msgspec.Struct, forbid_unknown_fields=True, frozen=True, omit_defaults=True):
    """One item of a form.

    Attributes:
        label: The question.
        kind: "text"; "number"; "scale", a number that is marked between two ends; "choice", one of several.
        choices: Of a choice.
        low, high: Limits of a number or scale; None: without.
        step: Step of a scale, 0: any value.
        low_label, high_label: What the ends of a scale mean.
        required: Whether an answer is needed.
    """

    label: Annotated[str, Meta(min_length=1, max_length=300)]
    kind: Literal["text", "number", "scale", "choice"] = "text"
    choices: list[str] = []
    low: float | None = None
    high: float | None = None
    step: Annotated[float, Meta(ge=0.0)] = 0.0
    low_label: str = ""
    high_label: str = ""
    required: bool = True

    @property
    def fault(self) -> str:
        """What is wrong with the item; "" where nothing is."""
        if (self.kind == "choice") != bool(self.choices):
            return 'a "choice" has choices, and nothing else does'
        if self.kind == "scale" and (self.low is None or self.high is None):
            return 'a "scale" has "low" and "high"'
        if self.low is not None and self.high is not None and not self.low < self.high:
            return '"low" is below "high"'
        return ""


class Form(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """A form: a title and its items by name, in their order."""

    title: str
    items: Annotated[dict[str, Item], Meta(min_length=1)]


class AnswersError(UsageError):
    """Answers that a form does not take: the fault of each item, with its name as the pointer.

    Args:
        faults: Errors by the names of the items; one at least.
    """

    def __init__(self, faults: Mapping[str, UsageError]) -> None:
        self._issues = [Issue("", f"/{escape(name)}", error.what, error.fix) for name, error in faults.items()]
        super().__init__(self._issues[0].what, self._issues[0].fix)

    @property
    def issues(self) -> list[Issue]:
        """The fault of each item, in the order of the form."""
        return self._issues


def check_answers(form: Form, given: Mapping[str, object]) -> dict[str, Answer]:
    """Return the answers by the names of the items, numbers as numbers.

    Args:
        form: The form.
        given: Values as typed or as in a file.

    Raises:
        AnswersError: Answers are missing, or are none that their items take.
        UsageError: The form has no item of a name.
    """
    for name in given:
        if name not in form.items:
            raise UsageError(f'the form has no item "{name}"', nearest(name, form.items))
    answers: dict[str, Answer] = {}
    faults: dict[str, UsageError] = {}
    for name, item in form.items.items():
        try:
            answers[name] = _checked(name, item, given.get(name, ""))
        except UsageError as error:
            faults[name] = error
    if faults:
        raise AnswersError(faults)
    return {name: value for name, value in answers.items() if value != ""}


def item_words(name: str, item: Item) -> str:
    """Return an item for a person who answers it, in the present language; choices are those that are typed."""
    label = translated(item.label)
    if item.kind == "choice":
        return f"{name}: {label} ({' | '.join(item.choices)})"
    if item.kind == "text":
        return f"{name}: {label}"
    ends = [_end(item.low, item.low_label), _end(item.high, item.high_label)]
    return f"{name}: {label} ({' – '.join(ends)})"


def _end(value: float | None, label: str) -> str:
    return " ".join(filter(None, ("…" if value is None else f"{value:g}", translated(label))))


def _checked(name: str, item: Item, given: object) -> Answer:
    text = str(given).strip()
    if not text:
        if item.required:
            raise UsageError(phrase('"{code}" has no answer', code=name), item_words(name, item))
        return ""
    if item.kind == "choice" and text not in item.choices:
        what = phrase('"{code}": "{file}" is none of the choices', code=name, file=text)
        raise UsageError(what, item_words(name, item))
    if item.kind in ("text", "choice"):
        if len(text) > _LONGEST or not text.isprintable():
            what = phrase('"{code}" is too long or has control characters', code=name)
            raise UsageError(what, phrase("give one line of {n:d} at most", n=_LONGEST))
        return text
    return _number(name, item, text)


def _number(name: str, item: Item, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    low = -math.inf if item.low is None else item.low
    high = math.inf if item.high is None else item.high
    steps = (value - low) / item.step if item.kind == "scale" and item.step else 0.0
    if not (math.isfinite(value) and low <= value <= high and math.isclose(steps, round(steps), abs_tol=1e-9)):
        by = f" in steps of {item.step:g}" if item.step else ""
        what = phrase('"{code}": "{file}" is not a number that it takes', code=name, file=text)
        raise UsageError(what, f"{item_words(name, item)}{by}")
    return value


def _load(label: str, high_label: str = phrase("very high"), low_label: str = phrase("very low")) -> Item:
    return Item(label, "scale", low=0.0, high=100.0, step=5.0, low_label=low_label, high_label=high_label)


SHIPPED_FORMS: dict[str, Form] = {
    # Six scales of 0 to 100 in steps of 5, unweighted: Hart and Staveland 1988, Hart 2006.
    "nasa_tlx": Form(
        phrase("Task load (NASA-TLX)"),
        {
            "mental": _load(phrase("How much thinking did the task take?")),
            "physical": _load(phrase("How much bodily effort did the task take?")),
            "temporal": _load(phrase("How hurried was the pace?")),
            "performance": _load(
                phrase("How well did you do what you were to do?"), phrase("failed"), phrase("perfectly")
            ),
            "effort": _load(phrase("How hard did you have to work?")),
            "frustration": _load(phrase("How annoyed, discouraged or stressed were you?")),
        },
    ),
    "person": Form(
        phrase("About the participant"),
        {
            "age": Item(phrase("Age in years"), "number", low=0.0, high=130.0, required=False),
            "hand": Item(phrase("Preferred hand"), "choice", [phrase("left"), phrase("right"), phrase("both")]),
            "side": Item(phrase("Affected side"), "choice", [phrase("none"), "left", "right", "both"]),
        },
    ),
}
"""Forms that a new study can take by name."""
