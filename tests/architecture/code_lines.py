"""Lines of code of the package by part: `python -m tests.architecture.code_lines` prints the table of decision 008.

A line counts that holds code: no docstring, no comment, no blank line, no import, no `__all__`. With a commit the
command also prints how many of today's lines are in files that existed then, renamed ones included.
"""

from __future__ import annotations

import ast
import io
import subprocess
import sys
import tokenize
from collections import Counter
from fnmatch import fnmatch
from pathlib import Path

from tests.architecture.sources import PACKAGE, ROOT

__all__ = ["code_lines", "count_parts"]

_SILENT = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}

PARTS: dict[str, tuple[int, tuple[str, ...]]] = {
    "people that move": (
        8_000,
        (
            "world/content/motion/*",
            "world/files/gltf/:bending,clips,deforms,skins,unfolding",
            "world/components/:animation,encourager",
            "rendering/visual/:drawing/skinning,drawing/feedback,kernels/skin",
            "lab/:groups/crowd,groups/limb_reach,groups/skinning,groups/joint_mixing,visual/skinned_figure",
            "app/:bench/people_workload,commands/avatar",
            "scenarios/parts/:body_nodes",
            "scenarios/figures/:planted_feet",
        ),
    ),
    "sound": (
        5_000,
        (
            "rendering/audio/*",
            "app/cues/*",
            "lab/audio/*",
            "lab/:audio_bench,audio_figures,groups/spatialiser",
            "app/:bench/audio_soak,session/sound",
            "contracts/:ports/audio_port,shared_memory/sound_scene",
            "world/files/gltf/:sounds",
        ),
    ),
    "body signals, learning and the guided walk": (
        9_000,
        (
            "dsp/*",
            "estimation/*",
            "learning/*",
            "inputs/physio/*",
            "app/physio/*",
            "lab/physio/*",
            "lab/:physio_drawing,physio_figures,physio_maps,groups/load_of_the_person",
            "app/:commands/physio,session/body,session/body_replay,play/value_picture",
            "recording/:signals,signal_rows",
            "tasks/kinds/guided_walk/*",
            "scenarios/:guided_walk",
            "scenarios/figures/:alley_figure",
            "contracts/:messages/action_space",
        ),
    ),
    "displays, trackers and the avatar's cord": (
        9_000,
        (
            "inputs/trackers/*",
            "rendering/tactile/*",
            "rendering/visual/displays/*",
            "rendering/visual/presenting/*",
            "app/study/*",
            "rendering/visual/:passes/cord,stages/eye_pairs,surfaces/wall_windows,drawing/attached",
            "app/:bench/display_bench,commands/study,session/trackers,picture/shown_on",
            "contracts/ports/:display_port,display_choice,tracker_port",
            "lab/groups/:cord,cord_frame,head_prediction,lens_distortion,ripple_distance,stereo",
            "tasks/kinds/avatar_cord/*",
            "scenarios/:avatar_cord",
            "scenarios/figures/:tracked_figure",
            "maths/:cord",
            "world/:cords,components/cord,components/tactile,components/trackers",
        ),
    ),
}
"""Part: its budget, and its modules: a pattern, or a folder and names in it after a colon."""

REST = "touch, picture, world, tasks, recording, laboratory, application"


def code_lines(text: str) -> int:
    """Lines of code in a module's text."""
    lines = {
        line
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type not in _SILENT
        for line in range(token.start[0], token.end[0] + 1)
    }
    return len(lines.difference(*(range(node.lineno, (node.end_lineno or 0) + 1) for node in _no_code(text))))


def _no_code(text: str) -> list[ast.stmt]:
    """Imports, `__all__` and docstrings of a module."""
    found: list[ast.stmt] = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import | ast.ImportFrom):
            found.append(node)
        elif isinstance(node, ast.Assign | ast.AnnAssign) and "__all__" in _assigned(node):
            found.append(node)
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            found.append(node)  # a docstring, also of a constant
    return found


def _assigned(node: ast.Assign | ast.AnnAssign) -> set[str]:
    """Names that a statement binds, with or without a type."""
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    return {target.id for target in targets if isinstance(target, ast.Name)}


def _is_in(module: str, patterns: tuple[str, ...]) -> bool:
    for pattern in patterns:
        folder, _, names = pattern.rpartition(":")
        if not folder and fnmatch(module, pattern):
            return True
        if folder and any(module == f"{folder.rpartition('/')[0]}/{name}.py" for name in names.split(",")):
            return True
    return False


def count_parts(package: Path = PACKAGE) -> Counter[str]:
    """Lines of code of each part, and of the rest."""
    counts: Counter[str] = Counter()
    for file in sorted(package.rglob("*.py")):
        module = file.relative_to(package).as_posix()
        part = next((name for name, (_, patterns) in PARTS.items() if _is_in(module, patterns)), REST)
        counts[part] += code_lines(file.read_text(encoding="utf-8"))
    return counts


def _git(*words: str) -> str:
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True).stdout


def lines_since(commit: str) -> tuple[int, int, int]:
    """(lines at a commit, today's files of the package that existed then under any name, their lines today)."""
    then = [
        path for path in _git("ls-tree", "-r", "--name-only", commit, PACKAGE.name).splitlines() if path.endswith(".py")
    ]
    known = set(then)
    log = _git(
        *("log", "--reverse", "--topo-order", "--no-merges", "--diff-filter=R", "--find-renames", "-l0"),
        *("--name-status", "--format=", f"{commit}..HEAD", "--", PACKAGE.name),
    )
    for line in filter(None, log.splitlines()):
        _, before, after = line.split("\t")
        if before in known:
            known.add(after)
    today = [file for file in PACKAGE.rglob("*.py") if file.relative_to(ROOT).as_posix() in known]
    lines = sum(code_lines(_git("show", f"{commit}:{path}")) for path in then)
    return lines, len(today), sum(code_lines(file.read_text(encoding="utf-8")) for file in today)


if __name__ == "__main__":
    found = count_parts()
    for name, (budget, _) in {**PARTS, REST: (44_000, ())}.items():
        print(f"| {name} | {found[name]:,} | {budget:,} |")
    print(f"| all | {found.total():,} | {sum(budget for budget, _ in PARTS.values()) + 44_000:,} |")
    for commit in sys.argv[1:]:
        lines, files, today = lines_since(commit)
        print(f"{commit}: {lines:,} lines then; {today:,} of today's lines are in {files} files that existed then")
