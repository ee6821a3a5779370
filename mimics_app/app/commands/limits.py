"""`mimics limits [NAME VALUE]`: the operator's ceiling of this machine, which no scene can raise."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping

from mimics_app.app.terminal.output import answer
from mimics_app.contracts.errors import OutputError, UsageError

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = "A scene may narrow every limit. The ceiling replaces a value beyond it, and a run says so."
    parser.add_argument("name", nargs="?", help="limit to set, as in a scene's safety; absent: print all")
    parser.add_argument("value", nargs="?", type=float, help="its new ceiling")
    parser.add_argument(
        "--reset", action="store_true", help="back to the conservative value; without NAME: all of them"
    )


def run(args: argparse.Namespace) -> int:
    """Set a ceiling or put one back, and print those in force."""
    from mimics_app.app.terminal.user_files import config_file
    from mimics_app.app.touch.ceilings import CEILINGS, FILE, read_ceiling

    if args.reset == (args.value is not None) and (args.name or args.reset):
        raise UsageError("name a limit with a value, or with --reset", "mimics limits force_limit 60")
    if args.reset and args.name is None:
        for name in CEILINGS:
            _keep(name, None)
    elif args.name is not None:
        _keep(args.name, args.value)
    ceiling = read_ceiling()
    rows = [
        {"name": name, "value": ceiling[name], "conservative": bound.conservative, "unit": bound.unit or "1"}
        for name, bound in CEILINGS.items()
    ]
    answer(args, {"file": str(config_file(FILE)), "limits": rows}, _lines(ceiling))
    return 0


def _keep(name: str, value: float | None) -> None:
    from mimics_app.app.terminal.user_files import config_file
    from mimics_app.app.touch.ceilings import CEILINGS, FILE, read_ceiling, set_ceiling

    set_ceiling(name, value)
    wanted = CEILINGS[name].conservative if value is None else value
    if read_ceiling()[name] != wanted:
        raise OutputError(
            f"{config_file(FILE)} cannot be written; the ceiling is unchanged", "check the folder's permissions"
        )


def _lines(ceiling: Mapping[str, float]) -> Iterator[str]:
    from mimics_app.app.terminal.user_files import config_file
    from mimics_app.app.touch.ceilings import CEILINGS, FILE

    yield f"Ceiling of this machine for the limits of every scene ({config_file(FILE)})"
    for name, bound in CEILINGS.items():
        side = "at least" if bound.is_floor else "at most"
        set_here = (
            "" if ceiling[name] == bound.conservative else f"  (set here; {bound.shown(bound.conservative)} otherwise)"
        )
        yield f"  {name:20}  {side} {bound.shown(ceiling[name]):12}  {bound.meaning}{set_here}"
