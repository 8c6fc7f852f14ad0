"""The command line: ``fuzzy-workbench`` and ``python -m app``."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

import tyro

from app.commands.check import check
from app.commands.convert import convert
from app.commands.doctor import doctor
from app.commands.explain import explain
from app.commands.failure import UsageError, describe
from app.commands.infer import infer
from app.commands.paper import paper
from app.commands.serve import serve
from app.commands.simulate import simulate

COMMANDS = {
    "serve": serve,
    "check": check,
    "infer": infer,
    "explain": explain,
    "convert": convert,
    "simulate": simulate,
    "paper": paper,
    "doctor": doctor,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Args:
        arguments: The words of the command line, by default those of this process.

    Returns:
        Exit code: 0 ok, 1 findings or failed, 2 wrong use.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        code = tyro.extras.subcommand_cli_from_dict(
            COMMANDS,
            prog="fuzzy-workbench",
            description="Design a fuzzy controller by hand and see at once what a continuum robot arm does with it.",
            args=_with_command(words),
            config=(tyro.conf.FlagCreatePairsOff,),
        )
        sys.stdout.flush()
    except UsageError as error:
        print(f"fuzzy-workbench: error: {error}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        # Whoever read the output has had enough. The interpreter flushes once more at its end: into nothing.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt:
        return 130
    except Exception as error:
        mistake = describe(error)
        if mistake is None:
            raise
        print(mistake, file=sys.stderr)
        return 1
    return code


def _with_command(words: list[str]) -> list[str]:
    """Return the command line with ``serve`` where it names no command: ``fuzzy-workbench FILE``, ``--port 9000``."""
    first = words[0] if words else ""
    if first in COMMANDS or first in ("-h", "--help"):
        return words
    looks_like_a_file = "." in first or os.sep in first
    return ["serve", *words] if not first or first.startswith("-") or looks_like_a_file else words


if __name__ == "__main__":
    sys.exit(main())
