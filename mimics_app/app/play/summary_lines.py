"""Result of a run as lines for the terminal, from the object of `--json`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mimics_app.contracts.errors import counted
from mimics_app.contracts.messages.trial_counts import COUNTED_PRACTICE

__all__ = ["summary_lines"]

_STATES = {
    "HOMED": "robot at rest",
    "READY": "robot ready",
    "ACTIVE": "force on",
    "DEGRADED": "force held",
    "SAFE_STOP": "stopped",
    "E_STOP": "stopped",
}
"""Final state of the haptic loop, in words."""


def summary_lines(answer: Mapping[str, Any]) -> list[str]:
    """Return the lines, each with a caption.

    Args:
        answer: Object of `mimics run --json`.
    """
    task = answer["task"]
    lines = [("task", _trials(task)), *_practice(task), *_path(task), ("carried", _of_practice(task, _carried(task)))]
    lines += [("touch", _touch(answer)), ("link", _link(answer.get("link", {}))), ("safety", _safety(answer["safety"]))]
    lines += [("orthosis", _resistance(answer.get("residual_torque_nm", {}))), ("run", answer["run_dir"])]
    lines += [("picture", str(picture)) for picture in answer["pictures"]]
    lines += [("film", str(answer.get("video", ""))), ("report", answer["report"])]
    return [f"{name:9} {text}" for name, text in lines if text]


def _trials(task: Mapping[str, Any]) -> str:
    trials = task["trials"]
    if trials:
        figures = _points_and_time(task, trials) if task["completed"] else []
        return "; ".join([f"{task['completed']} of {counted(trials, 'trials')} finished", *figures])
    under_way = "time_s" in task and not _is_practice(task)
    return "no trial ended" + (f"; {task['time_s']:.1f} s under way" if under_way else "")


def _points_and_time(task: Mapping[str, Any], trials: int) -> list[str]:
    mean = "mean " if trials > 1 else ""
    points = [f"{mean}score {task['score']:.0f} of 100"] if "score" in task else []
    return points + ([f"{mean}time {task['time_s']:.1f} s"] if "time_s" in task else [])


def _is_practice(task: Mapping[str, Any]) -> bool:
    """Whether the totals are those of practice, because no trial has ended."""
    return bool(task.get("counted") == COUNTED_PRACTICE)


def _of_practice(task: Mapping[str, Any], text: str) -> str:
    return f"{text} (in practice)" if text and _is_practice(task) else text


def _practice(task: Mapping[str, Any]) -> list[tuple[str, str]]:
    practice = task.get("practice")
    if practice is None:
        return []
    measured = _is_practice(task) and practice["completed"]
    figures = _points_and_time(task, practice["trials"]) if measured else []
    return [
        (
            "practice",
            "; ".join([f"{practice['completed']} of {counted(practice['trials'], 'trials')} finished", *figures]),
        )
    ]


def _path(task: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return the distance from the task's path and the contacts; without a path the contacts alone, if any."""
    contacts = str(task.get("contacts", ""))
    if "path_error_m" not in task:
        return [("contacts", _of_practice(task, contacts))] if task.get("contacts") else []
    error = f"{1e3 * task['path_error_m']:.1f} mm from the path"
    text = f"{error}, {counted(task['contacts'], 'contacts')}" if contacts else error
    return [("path", _of_practice(task, text))]


def _carried(task: Mapping[str, Any]) -> str:
    if "drops" not in task:
        return ""
    parts = [f"{task['placed']} placed", counted(task["drops"], "drops"), counted(task["bruises"], "bruises")]
    if "grasp_error_n" in task:
        parts.append(f"grip force {task['grasp_error_n']:.1f} N off its target")
    return ", ".join(parts)


def _touch(answer: Mapping[str, Any]) -> str:
    state = _STATES.get(answer["safety"]["state"], "robot off")
    if "missed" not in answer:
        return f"simulated {answer['simulated_s']:.1f} s; {state}"
    late = f"{answer['missed'] or 'none'} of {answer['ticks']:,} control cycles late"
    return f"{answer['simulated_s']:.1f} s; {late}; {state}"


def _resistance(rms: Mapping[str, tuple[float, float]]) -> str:
    """Return what legs that swing freely feel of a gait orthosis, root mean square; "" for any other run."""
    joints = [f"{left:.1f} N m at the left {joint}, {right:.1f} at the right" for joint, (left, right) in rms.items()]
    return f"resists by {'; '.join(joints)} (RMS)" if joints else ""


def _link(link: Mapping[str, Any]) -> str:
    """Return how well the device's data came; "" without a device."""
    if not link:
        return ""
    share = f"new data in {100.0 * link['fresh_share']:.2f} % of the control cycles"
    return f"{share}; longest gap {link['worst_gap_ms']:.1f} ms; jitter {link['jitter_us']:.0f} µs"


def _safety(safety: Mapping[str, Any]) -> str:
    """Return the numbers of stops and of short holds, and the cause of the last one; "" where there was none."""
    if not safety["stops"] and not safety["holds"]:
        return ""
    line = f"{counted(safety['stops'], 'stops')}, {counted(safety['holds'], 'short holds')}"
    return f"{line}; {safety['what']} ({safety['t_s']:.1f} s)" if "what" in safety else line
