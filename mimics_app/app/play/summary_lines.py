"""What a run came to, for a person at the terminal: a figure that the object of `--json` has not is not told either."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = ["summary_lines"]

_STATES = {
    "HOMED": "robot at rest",
    "READY": "robot ready",
    "ACTIVE": "force on",
    "DEGRADED": "force held",
    "SAFE_STOP": "stopped",
    "E_STOP": "stopped",
}
"""The states a run may end in, in words."""


def summary_lines(answer: Mapping[str, Any]) -> list[str]:
    """The lines, each with a word in front that says what it is about.

    Args:
        answer: The object of `mimics run --json`.
    """
    lines = [("task", _trials(answer["task"])), *_practice(answer["task"]), ("path", _path(answer["task"]))]
    lines += [("carried", _carried(answer["task"])), ("touch", _touch(answer)), ("safety", _safety(answer["safety"]))]
    lines += [("run", answer["run_dir"])]
    lines += [("picture", str(picture)) for picture in answer["pictures"]]
    lines += [("film", str(answer.get("video", ""))), ("report", answer["report"])]
    return [f"{name:9} {text}" for name, text in lines if text]


def _trials(task: Mapping[str, Any]) -> str:
    trials, mean = task["trials"], "mean " if task["trials"] > 1 else ""
    parts = [f"{task['completed']} of {_count(trials, 'trial')} finished" if trials else "no trial ended"]
    if trials and "score" in task:
        parts.append(f"{mean}score {task['score']:.0f} of 100")
    if "time_s" in task:
        parts.append(f"{mean}time {task['time_s']:.1f} s" if trials else f"{task['time_s']:.1f} s under way")
    return "; ".join(parts)


def _practice(task: Mapping[str, Any]) -> list[tuple[str, str]]:
    practice = task.get("practice")
    if practice is None:
        return []
    return [("practice", f"{practice['completed']} of {_count(practice['trials'], 'trial')} finished")]


def _path(task: Mapping[str, Any]) -> str:
    error = f"{1e3 * task['path_error_m']:.1f} mm from the way" if "path_error_m" in task else ""
    contacts = _count(task["contacts"], "contact") if "contacts" in task else ""
    return ", ".join(part for part in (error, contacts) if part)


def _carried(task: Mapping[str, Any]) -> str:
    if "drops" not in task:
        return ""
    parts = [f"{task['placed']} placed", _count(task["drops"], "drop"), _count(task["bruises"], "bruise")]
    if "grasp_error_n" in task:
        parts.append(f"grip {task['grasp_error_n']:.1f} N from the right force")
    return ", ".join(parts)


def _touch(answer: Mapping[str, Any]) -> str:
    state = _STATES.get(answer["safety"]["state"], "robot off")
    if "missed" not in answer:
        return f"simulated {answer['simulated_s']:.1f} s; {state}"
    late = f"{answer['missed'] or 'no'} late control cycle{'' if answer['missed'] == 1 else 's'}"
    return f"{answer['simulated_s']:.1f} s at 1 kHz ({answer['recipe']}), {late}; {state}"


def _safety(safety: Mapping[str, Any]) -> str:
    """Stops and short holds apart, and what the last of them was; "" where there was none."""
    if not safety["stops"] and not safety["holds"]:
        return ""
    line = f"{_count(safety['stops'], 'stop')}, {_count(safety['holds'], 'short hold')}"
    return f"{line}; {safety['what']} ({safety['t_s']:.1f} s)" if "what" in safety else line


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
