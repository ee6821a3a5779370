"""Verdict on a recording, the same for verify, recover and the report."""

from __future__ import annotations

from dataclasses import dataclass

from mimics_app.recording.run import Run, ending

__all__ = ["Verdict", "evaluate"]


@dataclass(frozen=True, slots=True)
class Verdict:
    """Status of a run, and its problems: missing, damaged, or changed after it was closed.

    Attributes:
        status: "clean", "interrupted", "recovered", or "open" where it was not closed.
        problems: One sentence each; () for a whole run.
        fresh: Problems that its manifest did not state when it was sealed.
    """

    status: str
    problems: tuple[str, ...]
    fresh: tuple[str, ...]

    @property
    def whole(self) -> bool:
        """Whether nothing is missing, damaged or changed."""
        return not self.problems

    @property
    def word(self) -> str:
        """Verdict in one word: "verified", "damaged", "not verified", or the status where all losses were stated."""
        if self.status == "open":
            return "not verified"
        return "damaged" if self.fresh else "verified" if self.whole else self.status

    @property
    def losses(self) -> tuple[str, ...]:
        """Problems without the sentence on the status."""
        return tuple(sentence for sentence in self.problems if sentence != ending(self.status))


def evaluate(run: Run) -> Verdict:
    """Return the verdict on the present files of a run."""
    found = [*run.problems(), *run.disagreements()]
    trouble = run.manifest.problem if run.manifest else ""
    if trouble and not any(trouble in sentence for sentence in found):
        found.append(trouble)
    problems = tuple(dict.fromkeys(found))
    stated = {ending(run.status), trouble, *(run.manifest.lost if run.manifest else ())}
    return Verdict(run.status, problems, tuple(sentence for sentence in problems if sentence not in stated))
