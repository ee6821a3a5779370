"""Entry point of the command `mimics`, and of `python -m mimics_app`."""

import os
import sys

__all__ = ["main"]


def main() -> int:
    """Run the command line of this process; Ctrl-C while it is still being imported is an exit like any other.

    Returns:
        The exit code.
    """
    try:
        _speak_utf8()
        from mimics_app.app import cli

        return cli.main()
    except KeyboardInterrupt:
        sys.stderr.write("mimics: interrupted\n")
        return 130


def _speak_utf8() -> None:
    """Begin again in UTF-8 where files and streams have an encoding of 128 characters, as in the locale C."""
    if sys.getfilesystemencoding() == "ascii" and sys.platform != "win32":
        os.environ["PYTHONUTF8"] = "1"  # for the processes of a session, too
        os.execv(sys.executable, [sys.executable, "-m", "mimics_app", *sys.argv[1:]])
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # what another encoding lacks is written as its number
            stream.reconfigure(errors="backslashreplace")


if __name__ == "__main__":
    sys.exit(main())
