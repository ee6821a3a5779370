"""`mimics config SCENE [options of mimics run]`: the values a run would begin with, and the source of each."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import asdict, fields
from typing import TYPE_CHECKING

from mimics_app.app.commands.run import add_arguments as add_arguments_of_run
from mimics_app.app.settings import RunSettings
from mimics_app.app.terminal.display import has_display
from mimics_app.app.terminal.output import answer, applicable

if TYPE_CHECKING:
    from mimics_app.app.session.effective_settings import EffectiveSetting

__all__ = ["add_arguments", "run"]

_TITLES = {
    "run": "Options of mimics run",
    "fitted": "Fitted to the person",
    "safety": "Limits and thresholds of the haptic loop; they cannot be changed during a run",
    "tolerances": "Errors that the planner accepts; mimics explain shows what it chooses",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `mimics run`."""
    add_arguments_of_run(parser)
    parser.epilog = (
        "Precedence: device, then command line, then what is kept with the participant, then scene, then profile, "
        "then default."
    )
    described = {action.dest: action.help for action in parser._actions if action.help}
    parser.set_defaults(meanings={name: text for name, text in described.items() if text != argparse.SUPPRESS})


def run(args: argparse.Namespace) -> int:
    """Prepare the run as `mimics run` would, print its values, and close the device without moving it."""
    from mimics_app.app.commands.run import check_names, take_kept_with_participant

    check_names(args)
    stated = args.avatar, args.fit
    take_kept_with_participant(args)
    kept = {name for name, value in zip(("avatar", "fit"), stated, strict=True) if value is None}
    settings = RunSettings(**{field.name: getattr(args, field.name) for field in fields(RunSettings)})
    from mimics_app.app.session.effective_settings import effective_settings
    from mimics_app.app.session.preparation import prepare

    parts = prepare(settings, live=has_display() and not settings.headless)
    try:
        shown = effective_settings(parts, args.meanings, kept)
    finally:
        parts.plugin.close()
    answer(args, applicable({"settings": [asdict(setting) for setting in shown]}), _lines(shown))
    return 0


def _lines(settings: list[EffectiveSetting]) -> Iterator[str]:
    """Yield a table per section, without the options that request nothing."""
    shown = [each for each in settings if each.value not in ("", None)]
    for section, title in _TITLES.items():
        rows = [(each.name, _text(each), each.origin) for each in shown if each.section == section]
        if not rows:
            continue
        name, value = (max(len(row[k]) for row in rows) for k in (0, 1))
        yield title
        for row in rows:
            yield f"  {row[0]:{name}}  {row[1]:{value}}  {row[2]}"
        yield ""


def _text(setting: EffectiveSetting) -> str:
    value = setting.value
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:g} {setting.unit}".rstrip() if isinstance(value, float) else str(value)
