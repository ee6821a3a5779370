"""The command line: finds the command, imports its module alone, and turns errors into lines and exit codes.

Exit codes: 0 ok, 2 usage, 3 scene or file, 4 device, 5 safety stop, 6 partial data, 129 the terminal was closed, 130
Ctrl-C, 143 SIGTERM.
"""

from __future__ import annotations

import argparse
import importlib
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any, NoReturn

from mimics_app import __version__
from mimics_app.contracts.errors import Issue, MimicsError, SceneError, UsageError, nearest

__all__ = ["COMMANDS", "build_parser", "main"]

COMMANDS: dict[str, str] = {
    "run": "run a scene: in a window, or headless with the simulated patient",
    "render": "draw frames of a scene to PNG files",
    "view": "look at a model or a scene from all sides; draw contact sheets",
    "check": "validate scene files and report every error",
    "schema": "print the JSON Schema of scene files",
    "explain": "say what a scene runs, by which methods, at which cost and error",
    "doctor": "say what this machine has, what it lacks and how to get it",
    "devices": "list devices, simulators, displays, gamepads and serial ports",
    "replay": "simulate a recorded run again and compare every output",
    "report": "write the report of a run as one HTML file",
    "record": "say what a recording holds, mend it, or verify it",
    "sweep": "run an experiment over a grid or sample of parameters, scenes and simulated patients",
    "bench": "measure the product against rivals on this machine",
    "lab": "chart speed against accuracy, and show where methods fail",
    "assets": "build the shipped models and sounds anew, exactly",
    "warmup": "compile the kernels now instead of at the first run",
}
"""Each is a module of `app.commands` with `add_arguments(parser)` and `run(args)`; with none given `launch` runs."""

_LAUNCHER = "launch"
_EXIT_INTERNAL = 1
_EXIT_BROKEN_PIPE = 128 + 13
_STDERR = 2


class _Parser(argparse.ArgumentParser):
    """A parser that raises instead of printing two lines and leaving."""

    def error(self, message: str) -> NoReturn:
        raise UsageError(message, f"see {self.prog} --help")


class _Help(argparse.ArgumentDefaultsHelpFormatter):
    """Tells defaults that say something."""

    def _get_help_string(self, action: argparse.Action) -> str | None:
        return action.help if action.default in (None, False, "") else super()._get_help_string(action)


def build_parser(command: str | None = None) -> argparse.ArgumentParser:
    """The parser of the whole command line, with the arguments of one command filled in.

    Args:
        command: The command whose module may be imported; None imports no command at all.
    """
    parser = _Parser(
        prog="mimics",
        description="One scene rendered as touch (1 kHz), picture and sound. Without a command: the launcher.",
        epilog="mimics COMMAND --help describes one command.",
    )
    parser.add_argument("--version", action="version", version=f"mimics {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", dest="command", required=True)
    for name, description in COMMANDS.items():
        one = commands.add_parser(
            name,
            help=description,
            description=f"{description[0].upper()}{description[1:]}.",
            formatter_class=_Help,
        )
        if name == command:
            _fill(one, name)
    return parser


def _fill(parser: argparse.ArgumentParser, name: str) -> None:
    module = _command_module(name)
    module.add_arguments(parser)
    parser.add_argument("--json", action="store_true", help="write one JSON object to stdout, all else to stderr")
    parser.set_defaults(run=module.run)


def _command_module(name: str) -> Any:
    """The module of a command. The one place where a module is named by a string (tests/architecture knows it)."""
    return importlib.import_module(f"mimics_app.app.commands.{name}")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line.

    Args:
        argv: Arguments without the program's name; None takes those of the process.

    Returns:
        The exit code.
    """
    _open_missing_streams()
    arguments = list(sys.argv[1:] if argv is None else argv)
    as_json = "--json" in arguments
    try:
        with ExitStack() as stack:
            stack.enter_context(_terminated_by_exception())
            if as_json:
                from mimics_app.app.terminal import output

                stack.enter_context(output.reserved_stdout())
            return _guarded(arguments, as_json)
    except KeyboardInterrupt:  # before or after the command itself
        return 128 + signal.SIGINT
    except BrokenPipeError:  # the reader was gone when the error was told
        return _EXIT_BROKEN_PIPE


def _open_missing_streams() -> None:
    """Lead stdin, stdout and stderr that came closed to nowhere: a file opened in their place would be written to."""
    while (descriptor := os.open(os.devnull, os.O_RDWR)) <= _STDERR:
        os.set_inheritable(descriptor, True)
    os.close(descriptor)
    if sys.stdout is None:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")


def _guarded(arguments: list[str], as_json: bool) -> int:
    """Run the command and say its error, if any, in the form asked for."""
    try:
        return _dispatch(arguments)
    except MimicsError as error:
        _say(arguments, error.issues, as_json)
        return error.exit_code
    except KeyboardInterrupt:
        sys.stderr.write("mimics: interrupted\n")
        return 128 + signal.SIGINT
    except BrokenPipeError:  # the reader (head, less) has seen enough
        _silence_stdout()
        return _EXIT_BROKEN_PIPE
    except Exception as error:
        if _Terminated.came:  # its exception was lost, and this one is what was left behind
            return 128 + _Terminated.came
        if isinstance(error, OSError) and error.strerror:  # a folder that is a file, a full disk: nobody's bug
            return _say_file_trouble(arguments, error, as_json)
        if not as_json:
            raise
        sys.excepthook(type(error), error, error.__traceback__)
        _say(arguments, [Issue("", "", f"internal error: {type(error).__name__}: {error}")], as_json)
        return _EXIT_INTERNAL


def _say_file_trouble(arguments: list[str], error: OSError, as_json: bool) -> int:
    """One line that names the file, where the system does."""
    file = os.fsdecode(error.filename) if isinstance(error.filename, str | bytes) else ""
    if not file:  # perhaps stdout itself
        _silence_stdout()
    _say(arguments, [Issue(file, "", str(error.strerror))], as_json)
    return SceneError.exit_code


def _silence_stdout() -> None:
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


def _dispatch(arguments: list[str]) -> int:
    if not arguments:
        return int(_command_module(_LAUNCHER).run(argparse.Namespace(command=_LAUNCHER, json=False)))
    command = _command_of(arguments)
    try:
        args = build_parser(command).parse_args(arguments)
    except SystemExit as leave:  # --help and --version
        return int(leave.code or 0)
    return int(args.run(args))


def _command_of(arguments: list[str]) -> str | None:
    """The command asked for, None where an option such as --help stands in its place."""
    word = arguments[0]
    if word.startswith("-"):
        return None
    if word not in COMMANDS:
        raise UsageError(f'there is no command "{word}"', nearest(word, COMMANDS))
    return word


def _say(arguments: list[str], issues: Sequence[Issue], as_json: bool) -> None:
    """One line per issue on stderr, or one object on stdout; of very many the first ones, and how many more."""
    from mimics_app.app.terminal import output

    if not as_json:
        sys.stderr.writelines(output.issue_lines(issues))
        return
    if output.object_written():  # the answer stands already; a second object would break its reader
        _say(arguments, issues, as_json=False)
        return
    command = arguments[0] if arguments[0] in COMMANDS else ""
    output.write_object(command, output.errors_of(issues), schema="errors")


class _Terminated:
    """The signal that came, or 0: an exception raised inside a compiler's callback can be swallowed on its way up."""

    came = 0


@contextmanager
def _terminated_by_exception() -> Iterator[None]:
    """Let SIGTERM, and SIGHUP of a closed terminal, unwind the stack like Ctrl-C, so that recordings are closed.

    The exit code is 143 or 129. What nohup told to be ignored is ignored.
    """
    _Terminated.came = 0

    def leave(number: int, _frame: object) -> None:
        _Terminated.came = number
        raise SystemExit(128 + number)

    numbers = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
    before = {number: signal.getsignal(number) for number in numbers}
    ours = {number: handler for number, handler in before.items() if handler not in (None, signal.SIG_IGN)}
    try:
        for number in ours:
            signal.signal(number, leave)
    except ValueError:  # not the main thread: somebody embeds us and owns the signals
        yield
        return
    try:
        yield
    finally:
        for number, handler in ours.items():
            signal.signal(number, handler)


if __name__ == "__main__":
    sys.exit(main())
