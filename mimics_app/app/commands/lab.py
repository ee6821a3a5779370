"""`mimics lab ACTION [NAME]`: chart speed against accuracy, and run experiments that show where methods fail."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.app.terminal.arguments import folder_to_write, whole_number
from mimics_app.app.terminal.output import answer, applicable

if TYPE_CHECKING:
    from mimics_app.lab.figure import Figure
    from mimics_app.lab.measure import MeasuredGroup

__all__ = ["add_arguments", "run"]

_EXIT_FAILED = 6
_POINTS = 24
_FOLDER = Path("charts")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics lab`."""
    parser.add_argument(
        "action",
        choices=("measure", "chart", "stability", "gait"),
        help="measure: table of cost and error; chart: the same as figures; stability: figures of stability limits; "
        "gait: the reference gait beside published tables",
    )
    parser.add_argument(
        "name",
        nargs="*",
        help='groups of methods, "whole scenes", or stability experiments such as S3 (default: all)',
    )
    parser.add_argument("--all", action="store_true", help="all groups or experiments, the same as no name")
    parser.add_argument(
        "--save", action="store_true", help="with measure: save the costs for the planner on this machine"
    )
    parser.add_argument(
        "--shipped",
        action="store_true",
        help="for developers, in a source checkout: replace the shipped table (measure, chart) and the figures of "
        "docs/charts (chart, stability)",
    )
    parser.add_argument(
        "--rounds",
        type=whole_number("number of rounds", range(1, 101)),
        default=1,
        metavar="N",
        help="with measure and chart: number of measurements; the lowest costs are kept",
    )
    parser.add_argument(
        "--points",
        type=whole_number("number of points", range(2, 2001)),
        default=_POINTS,
        help="with stability: number of grid points along each axis",
    )
    parser.add_argument("--out", type=folder_to_write, metavar="DIR", help="folder of the figures (default: charts)")


def run(args: argparse.Namespace) -> int:
    """Measure, chart or run experiments; exit code 6 where an experiment is outside its tolerance."""
    from mimics_app.contracts.errors import UsageError

    if args.all and args.name:
        raise UsageError("both a name and --all are given", "leave out one of them")
    if args.action != "measure":
        args.out = _folder(args)
    if args.action == "stability":
        return _stability(args)
    if args.action == "gait":
        return _gait(args)
    groups = _groups(args.name)
    measured = _measure(groups, args.rounds)
    return _show_table(args, measured) if args.action == "measure" else _chart(args, measured)


def _folder(args: argparse.Namespace) -> Path:
    """Return the folder of the figures: only --shipped replaces those that the product ships with.

    Raises:
        UsageError: --shipped with --out, or without a checkout.
    """
    from mimics_app.contracts.errors import UsageError
    from mimics_app.contracts.system.resources import root

    if not args.shipped:
        return args.out or _FOLDER
    if args.out is not None:
        raise UsageError("both --out and --shipped are given", "leave out one of them")
    shipped = root() / "docs" / "charts"
    if not shipped.is_dir():
        raise UsageError("the shipped figures exist in a source checkout only", "give a folder with --out DIR")
    return shipped


def _groups(words: list[str]) -> list[str]:
    """Return the names of the groups; blanks, hyphens and underscores are equal, and several words may be one name."""
    from mimics_app.app.bench.whole_scenes import GROUPS
    from mimics_app.lab.catalogue import all_groups

    groups = all_groups()
    if [word.replace("_", " ").lower() for word in words] in (["whole scenes"], ["whole", "scenes"]):
        return list(GROUPS)
    names = [word.replace("_", " ").replace("-", " ").lower() for word in words]
    if len(names) > 1 and " ".join(names) in (*groups, *GROUPS):
        return [" ".join(names)]
    known = {group.replace("-", " ").lower(): group for group in groups}
    return [known.get(name, name) for name in names] or groups


def _measure(groups: list[str], rounds: int) -> list[MeasuredGroup]:
    from mimics_app.app.bench.whole_scenes import GROUPS, register_whole
    from mimics_app.app.terminal.progress import ProgressBar
    from mimics_app.contracts.errors import UsageError
    from mimics_app.lab.catalogue import load_methods
    from mimics_app.lab.measure import count_probes, measure

    registry = load_methods([group for group in groups if group not in GROUPS])
    for group in groups:
        if group in GROUPS:
            register_whole(registry, group)
    if not (groups := [group for group in groups if group in registry.groups()]):
        raise UsageError("no method is left to measure", "mimics doctor checks the installed packages")
    with ProgressBar(sys.stderr, count_probes(registry, groups, rounds)) as bar:
        return [measure(group, registry, bar.step, rounds) for group in groups]


def _show_table(args: argparse.Namespace, measured: list[MeasuredGroup]) -> int:
    from mimics_app.lab.measure import as_dict
    from mimics_app.lab.measured_on import measured_on

    saved = _save_table(measured, shipped=args.shipped) if args.save or args.shipped else None
    machine = measured_on()
    lines = [f"{machine}\n", *(line for one in measured for line in _group_lines(one))]
    if args.save or args.shipped:
        lines.append(f"saved in {saved}" if saved else "not saved: no folder of this user is writable")
    groups = {one.group.name: as_dict(one) for one in measured}
    answer(args, applicable({"machine": machine.as_dict(), "groups": groups, "saved": saved}), lines)
    return 0


def _save_table(measured: list[MeasuredGroup], *, shipped: bool) -> Path | None:
    """Save the costs of these groups in the shipped table or in this machine's; return its file."""
    from mimics_app.app.bench.whole_scenes import GROUPS  # charted only: they offer the planner no choice
    from mimics_app.contracts.ports.method_table import Table, shipped_file
    from mimics_app.lab.measure import to_table

    newer, older = (
        to_table([one for one in measured if one.group.name not in GROUPS]),
        Table.load_shipped() if shipped else Table.load_saved(),
    )
    return (older.with_groups(newer) if older else newer).save(shipped_file() if shipped else None)


def _group_lines(one: MeasuredGroup) -> Iterator[str]:
    yield f"{one.group.name}: {one.group.what}"
    yield f"  {'':2}{'method':24} {'cost':>13} {'x reference':>12} {'error':>10} {one.group.unit}"
    for row in one.rows:
        growth = f"   n^{row.growth.exponent:.2f}" if row.growth else ""
        mark = "*" if row.method.default else " "
        yield f"  {mark} {row.method.name:24} {row.cost_us:10.4f} us {row.ratio:12.3f} {row.error:10.3g}{growth}"
    for name, why in one.skipped.items():
        yield f"    {name:24} not measured: {why}"
    yield ""


def _chart(args: argparse.Namespace, measured: list[MeasuredGroup]) -> int:
    from mimics_app.lab.chart import draw_chart

    if args.shipped:  # charts and table come from the same measurement
        _save_table(measured, shipped=True)
    return _write(args, [draw_chart(one) for one in measured])


def _stability(args: argparse.Namespace) -> int:
    from mimics_app.app.terminal.progress import ProgressBar
    from mimics_app.lab.stability.catalogue import load_experiments
    from mimics_app.lab.stability_chart import draw_outcome

    experiments = load_experiments(tuple(args.name))
    figures = []
    with ProgressBar(sys.stderr, len(experiments)) as bar:
        for experiment in experiments:
            bar.step(f"{experiment.name}: {experiment.title}")
            figures.append(draw_outcome(experiment, experiment.run(args.points), args.points))
    code = _write(args, figures)
    return code if all(figure.more["passed"] for figure in figures) else _EXIT_FAILED


def _gait(args: argparse.Namespace) -> int:
    from mimics_app.lab.gait_figure import gait_figure

    return _write(args, [gait_figure()])


def _write(args: argparse.Namespace, figures: list[Figure]) -> int:
    """Write the figures and the gallery, and print their files."""
    from mimics_app.lab.figure import write_figure
    from mimics_app.lab.gallery import write_gallery

    files = [write_figure(figure, args.out) for figure in figures]
    page = write_gallery(args.out, _limits())
    rows = [_row(figure, *pair) for figure, pair in zip(figures, files, strict=True)]
    lines = [f"{drawing}: {_summary(figure)}" for figure, (_, drawing) in zip(figures, files, strict=True)]
    answer(args, applicable({"figures": rows, "gallery": page}), [*lines, f"{page}: all figures"])
    return 0


def _limits() -> dict[str, dict[str, float]]:
    """Return the largest error that each profile accepts, by unit."""
    from mimics_app.app.planner.tolerances import BY_PROFILE
    from mimics_app.world.components.tolerance_units import FIELD_OF_UNIT

    return {
        profile: {unit: bounds[name] for unit, name in FIELD_OF_UNIT.items()} for profile, bounds in BY_PROFILE.items()
    }


def _row(figure: Figure, numbers: Path, drawing: Path) -> dict[str, Any]:
    row: dict[str, Any] = {"kind": figure.kind, "name": figure.name, "json": numbers, "svg": drawing}
    if figure.kind == "chart":
        return {**row, "front": figure.front, "default": figure.default, "skipped": figure.more["skipped"]}
    if figure.kind == "figure":
        return row | {"rows": figure.rows}
    more = {key: figure.more[key] for key in ("tolerance", "passed", "note")}
    return {**row, "disagreement": figure.boundary["disagreement"], **more}


def _summary(figure: Figure) -> str:
    if figure.kind == "chart":
        best = ", ".join(figure.front) or "none is valid"
        return f"best trade-offs: {best}; in use: {figure.default or 'none'}"
    if figure.kind == "figure":
        return "; ".join(f"{row['method']} {row['x']:.1f} km/h: {row['error']:.1f} degrees" for row in figure.rows)
    found, allowed = figure.boundary["disagreement"], figure.more["tolerance"]
    differ = f"differs from theory by {100.0 * found:.2g} % ({100.0 * allowed:.2g} % allowed)"
    return f"{figure.more['title']} {differ}: {'passed' if figure.more['passed'] else 'FAILED'}"
