"""What is to be said about a recording: one object, the same for verify, recover and the report."""

from __future__ import annotations

from dataclasses import dataclass

from mimics_app.recording.run import Run

__all__ = ["Verdict", "judge"]


@dataclass(frozen=True, slots=True)
class Verdict:
    """How a run ended, and everything that is missing, damaged, or was changed after it was closed.

    Attributes:
        status: "clean", "interrupted", "recovered", or "open" where nobody closed it.
        problems: One sentence each; () for a whole run.
    """

    status: str
    problems: tuple[str, ...]

    @property
    def whole(self) -> bool:
        """Whether nothing is missing, damaged or changed."""
        return not self.problems


def judge(run: Run) -> Verdict:
    """The verdict on a run as its files are now."""
    found = [*run.problems(), *run.disagreements()]
    trouble = run.manifest.problem if run.manifest else ""
    if trouble and not any(trouble in sentence for sentence in found):
        found.append(trouble)
    return Verdict(run.status, tuple(dict.fromkeys(found)))
