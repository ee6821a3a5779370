"""The command line: finds the command, imports its module alone, and turns errors into lines and exit codes.

Exit codes: 0 ok, 2 usage, 3 scene or file, 4 device, 5 safety stop, 6 partial data, 129 the terminal was closed, 130
Ctrl-C, 143 SIGTERM.
"""

from __future__ import annotations

import argparse
import atexit
import errno
import gc
import importlib
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from typing import Any

from mimics_app.app.terminal.command_parser import CommandParser, HelpFormatter, examples_of
from mimics_app.contracts.errors import Issue, MimicsError, SceneError, require_choice
from mimics_app.contracts.version import __version__

__all__ = ["COMMANDS", "main", "parse"]

COMMANDS: dict[str, str] = {
    "run": "run a scene: in a window, or headless with the simulated patient",
    "render": "draw frames of a scene to PNG files",
    "scenes": "list the shipped scenes: name, group, limbs that play, trials and duration",
    "view": "look at a model or a scene from all sides; draw contact sheets",
    "avatar": "make a person of given measures, or print which joint of a model is which bone",
    "check": "validate scenes and models and report every error",
    "schema": "print the JSON Schema of scene files",
    "explain": "print the parts of a scene: their methods, costs and errors",
    "config": "print the values a run would begin with, and the source of each",
    "limits": "show or set the ceiling of this machine, which no scene can raise",
    "doctor": "report what this machine has, what it lacks and how to install it",
    "devices": "list devices, simulators, displays, gamepads and serial ports; check or emulate a device",
    "console": "serve the operator's page, from which sessions are watched and steered in a browser",
    "mirror": "show the scene of a session on a second display, from its state, read only",
    "replay": "simulate a recorded run again and compare every output",
    "report": "write the report of a run as one HTML file",
    "physio": "read body signals from a file, a stream or a simulated person: plots, features, events, quality",
    "record": "show, repair, verify or export a recording",
    "study": "run a scene for several subjects and join their trials, taps and answers in tidy tables",
    "sweep": "run an experiment over a grid or sample of parameters, scenes and simulated patients",
    "bench": "measure the product beside its peers on this machine",
    "lab": "chart speed against accuracy, and show where methods fail",
    "assets": "build the shipped models and sounds from a seed; make levels of detail of any model",
    "completion": "print the script by which a shell completes commands, options and names of scenes",
    "desktop": "add the launcher to the desktop's menu of applications",
    "warmup": "compile the kernels now instead of at the first run",
}
"""Each is a module of `app.commands` with `add_arguments(parser)` and `run(args)`; with none given `launch` runs."""

_PROGRAM = "mimics"
_LAUNCHER = "launch"
_YOUNG_OBJECTS = 400_000
"""Threshold of the garbage collector's youngest generation [objects]. A start makes 250,000 to 330,000 objects that all
stay: searching them for cycles takes a tenth of it at Python's own threshold of 700, a thirtieth at 50,000."""

_CURES = dict.fromkeys(
    (errno.EROFS, errno.EACCES, errno.EPERM, errno.EEXIST, errno.ENOTDIR, errno.EISDIR), "name another file or folder"
) | {errno.ENOSPC: "free some space, or name a file or folder on another disk"}
"""What to do about an error of the operating system, by its number."""

_EXIT_INTERNAL = 1
_EXIT_BROKEN_PIPE = 128 + 13
_STDERR = 2


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Read a command line that is not empty; only the module of its command is imported.

    Raises:
        UsageError: It cannot be read, or the command is unknown.
        SystemExit: After --help or --version.
    """
    command = _command_of(arguments)
    if command is None:
        return _parser_of_all().parse_first(arguments)
    return _parser_of(command).parse(arguments[1:])


def _parser_of_all() -> CommandParser:
    """Return the parser of the words before a command; no command is imported."""
    parser = CommandParser(
        prog=_PROGRAM,
        description="One scene rendered as touch (1 kHz), picture and sound. Without a command: the launcher.",
        epilog="mimics COMMAND --help describes one command.",
    )
    parser.add_argument("--version", action="version", version=f"mimics {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", dest="command", required=True)
    for name, description in COMMANDS.items():
        commands.add_parser(name, help=description)
    return parser


def _parser_of(command: str) -> CommandParser:
    """Return the parser of the words after a command."""
    described = COMMANDS[command]
    parser = CommandParser(
        prog=f"{_PROGRAM} {command}",
        description=f"{described[0].upper()}{described[1:]}.",
        formatter_class=HelpFormatter,
    )
    module = _command_module(command)
    module.add_arguments(parser)
    parser.epilog = "\n".join(part for part in (parser.epilog, examples_of(command)) if part)
    parser.add_argument("--json", action="store_true", help="write one JSON object to stdout, all else to stderr")
    parser.set_defaults(command=command, run=module.run, known_commands=COMMANDS, parser_of=_parser_of)
    return parser


def _command_module(name: str) -> Any:
    """Return the module of a command; the only place where a module is named by a string (see tests/architecture)."""
    return importlib.import_module(f"mimics_app.app.commands.{name}")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line.

    Args:
        argv: Arguments without the program's name; None: those of the process.

    Returns:
        The exit code.
    """
    _open_missing_streams()
    gc.set_threshold(_YOUNG_OBJECTS)
    if argv is None:  # the process ends: a last collection of all objects would only take time
        atexit.register(gc.freeze)
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
    except BrokenPipeError:  # the reader was gone when the error was written
        return _EXIT_BROKEN_PIPE


def _open_missing_streams() -> None:
    """Open closed standard streams to the null device, so that no file gets their descriptors."""
    while (descriptor := os.open(os.devnull, os.O_RDWR)) <= _STDERR:
        os.set_inheritable(descriptor, True)
    os.close(descriptor)
    if sys.stdout is None:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")


def _guarded(arguments: list[str], as_json: bool) -> int:
    """Run the command and report its error, if any, in the form requested."""
    try:
        return _dispatch(arguments)
    except MimicsError as error:
        _say(arguments, error.issues, as_json)
        return error.exit_code
    except KeyboardInterrupt:
        _say(arguments, [Issue("", "", "interrupted")], as_json)
        return 128 + signal.SIGINT
    except SystemExit:
        if _Terminated.came:
            with suppress(OSError):  # the terminal may be what was closed
                _say(arguments, [Issue("", "", f"ended by {signal.Signals(_Terminated.came).name}")], as_json)
        raise
    except BrokenPipeError:  # the reader (head, less) has seen enough
        _silence_stdout()
        return _EXIT_BROKEN_PIPE
    except Exception as error:
        if _Terminated.came:  # a consequence of the signal, whose own exception was lost
            return 128 + _Terminated.came
        if isinstance(error, OSError) and error.strerror:  # a folder that is a file, a full disk: not our fault
            return _say_file_trouble(arguments, error, as_json)
        if not as_json:
            raise
        sys.excepthook(type(error), error, error.__traceback__)
        _say(arguments, [Issue("", "", f"internal error: {type(error).__name__}: {error}")], as_json)
        return _EXIT_INTERNAL


def _say_file_trouble(arguments: list[str], error: OSError, as_json: bool) -> int:
    """Report an error of the operating system in one line, with the file where the system names it."""
    file = os.fsdecode(error.filename) if isinstance(error.filename, str | bytes) else ""
    if not file:  # perhaps stdout itself
        _silence_stdout()
    _say(arguments, [Issue(file, "", str(error.strerror), _CURES.get(error.errno or 0, ""))], as_json)
    return SceneError.exit_code


def _silence_stdout() -> None:
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


def _dispatch(arguments: list[str]) -> int:
    if not arguments:
        return int(_command_module(_LAUNCHER).run(argparse.Namespace(command=_LAUNCHER, json=False)))
    try:
        args = parse(arguments)
    except SystemExit as leave:  # --help and --version
        return int(leave.code or 0)
    code = int(args.run(args))
    sys.stdout.flush()  # here, where its errors are reported and a signal unwinds the stack
    return code


def _command_of(arguments: Sequence[str]) -> str | None:
    """Return the command requested; None where an option such as --help is in its place."""
    word = arguments[0]
    if word.startswith("-"):
        return None
    require_choice(word, COMMANDS, "command")
    return word


def _say(arguments: list[str], issues: Sequence[Issue], as_json: bool) -> None:
    """Report the first issues and the number of the others: a line each on stderr, or one object on stdout."""
    from mimics_app.app.terminal import output

    if not as_json:
        sys.stderr.writelines(output.issue_lines(issues))
        return
    if output.object_written():  # a second object would break the reader of the first
        _say(arguments, issues, as_json=False)
        return
    command = arguments[0] if arguments[0] in COMMANDS else ""
    output.write_object(command, output.errors_of(issues), schema="errors")


class _Terminated:
    """Number of the signal that ends the process, 0 before; errors after it are its consequences."""

    came = 0


_AGAIN_S = 0.01
"""Delay after which a signal is raised again whose exception was dropped [s]."""


@contextmanager
def _terminated_by_exception() -> Iterator[None]:
    """Let SIGTERM, and SIGHUP of a closed terminal, unwind the stack like Ctrl-C, so that recordings are closed.

    The exit code is 143 or 129, of Ctrl-C 130. Signals that nohup ignores stay ignored. An exception cannot leave a
    callback of a compiler or a destructor: the interpreter would print it and continue; there it is dropped and raised
    again.
    """
    _Terminated.came = 0

    def leave(number: int, _frame: object) -> None:
        _Terminated.came = _Terminated.came or number
        if _Terminated.came == signal.SIGINT:
            raise KeyboardInterrupt
        raise SystemExit(128 + _Terminated.came)

    numbers = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
    before = {number: signal.getsignal(number) for number in numbers}
    ours = {number: handler for number, handler in before.items() if handler not in (None, signal.SIG_IGN)}
    try:
        for number in ours:
            signal.signal(number, leave)
    except ValueError:  # not the main thread: the embedding program owns the signals
        yield
        return
    try:
        with _raised_again(leave):
            yield
    finally:
        for number, handler in ours.items():
            signal.signal(number, handler)


@contextmanager
def _raised_again(leave: Callable[[int, object], None]) -> Iterator[None]:
    """Raise the exception of a signal again where it was dropped (`sys.unraisablehook`).

    After a signal, to the end of the process, a destructor may find its object half made: that is no message either.
    """
    if not hasattr(signal, "setitimer"):
        yield
        return

    def drop(dropped: sys.UnraisableHookArgs) -> None:
        if not _Terminated.came:
            usual(dropped)
        elif issubclass(dropped.exc_type, SystemExit | KeyboardInterrupt):  # others are its consequences
            signal.setitimer(signal.ITIMER_REAL, _AGAIN_S)

    from mimics_app.app.terminal.output import say_nothing

    usual, alarm = sys.unraisablehook, signal.signal(signal.SIGALRM, leave)
    sys.unraisablehook = drop
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        sys.unraisablehook = say_nothing if _Terminated.came else usual
        signal.signal(signal.SIGALRM, alarm)


if __name__ == "__main__":
    sys.exit(main())
