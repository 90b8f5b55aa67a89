"""The command line: one thin file a command, and one place where errors become a line and an exit
status.
"""

from __future__ import annotations

import itertools
import os
import signal
import sys
import threading
import traceback
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

import click

from ..base.interrupts import SENTENCE, STATUS, interrupts, keep_status
from ..base.standard_streams import lead_nowhere
from ..errors import LagrangeCasadiError, check_known, one_line
from ..version import __version__
from .commands import GROUPS, PLACES
from .echo import echo
from .help import command, write_commands

_NAME = "lagrange-casadi"
_COMPLETE = "_LAGRANGE_CASADI_COMPLETE"
"""The variable by which shells ask for completion, as click names it."""

_OPTIONS = {
    "resume=True": "--resume",
    "force=True": "--force",
    "many=True": "--yes",
    "accept_inertias=True": "--accept-inertias",
    "consistent=True": "--consistent",
    "which `load` reads": "which the commands info, plot and check read",
    "which `Sweep.open` reads": "which the commands table, best, info, plot and check read",
}
"""Options of the command line for the Python names in errors."""

_NUMPY = r"\s*casadi: a numpy function was called"
"""First words of CasADi's note that NumPy makes arrays of symbols, which is intended, and which
fills the screen.
"""


_MOMENT, _WAITS = 0.01, 50
"""Seconds that an interrupt waits for CasADi at a time, and how often: some
of its calls are long.
"""


class _Interrupted(Exception):  # noqa: N818 - it is no error
    """Ctrl-C, taken before click turns it into a line of its own."""


class _Unread(Exception):  # noqa: N818 - it is no error
    """The reader of standard output has closed it, as ``head`` does: nothing more is written."""


class _Commands(click.Group):
    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted(PLACES)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        return command(PLACES[cmd_name]) if cmd_name in PLACES else None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        write_commands(GROUPS, formatter)

    def invoke(self, ctx: click.Context) -> Any:
        with _read(), _Insistent():
            return super().invoke(ctx)

    def make_context(self, *arguments: Any, **keywords: Any) -> click.Context:
        with _read():  # help is said here
            return super().make_context(*arguments, **keywords)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if not ctx.resilient_parsing:
            check_known("command", [word for word in args[:1] if not word.startswith("-")], PLACES)
        return super().resolve_command(ctx, args)


@click.group(
    cls=_Commands,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(__version__, prog_name=_NAME)
def program() -> None:
    """Compute efforts, reactions and section forces of a mechanism with a given motion.

    COMMAND --help describes a command.
    """


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; the exit status is 0, 2 for a mistake in what was asked, 1 for a
    computation that failed.
    """
    if instruction := os.environ.get(_COMPLETE):
        from click.shell_completion import shell_complete

        return shell_complete(program, {}, _NAME, _COMPLETE, instruction)
    # Nothing is shown in windows, and what a notebook set is no backend elsewhere.
    os.environ["MPLBACKEND"] = "agg"
    with warnings.catch_warnings():
        warnings.simplefilter("always", UserWarning)
        warnings.filterwarnings("ignore", _NUMPY, FutureWarning)
        warnings.showwarning = lambda message, *_args, **_kwargs: _say(f"note: {message}")
        asked: dict[str, Any] = {}
        try:
            result = program.main(arguments, prog_name=_NAME, standalone_mode=False, obj=asked)
        except LagrangeCasadiError as error:
            from .drawing import drawn

            words, postures = drawn(error, asked)
            return _fail(f"{error}{words}", error.exit_status, *postures)
        except click.exceptions.NoArgsIsHelpError as error:
            _say(*error.format_message().splitlines())
            return error.exit_code
        except click.ClickException as error:
            return _fail(error.format_message(), error.exit_code)
        except _Interrupted:
            keep_status()
            return _fail(SENTENCE, STATUS)
        except _Unread:
            lead_nowhere()
            return 1
        except MemoryError as error:
            return _fail(f"out of memory: {str(error) or 'fewer instants or ratios fit'}", 1)
        except OSError as error:  # of help on standard output; all else is an error of ours
            return _fail(one_line(error), 1)
        except (KeyboardInterrupt, Exception):
            raise
        except BaseException as error:  # of a case, whose functions may be called late
            return _fail(f"{type(error).__name__}: {one_line(error)}", 1)
    return result if isinstance(result, int) else 0


@contextmanager
def _read() -> Iterator[None]:
    """Notice that nobody reads standard output any more, before click ends the program; files
    fail with an error of ours.
    """
    try:
        yield
    except BrokenPipeError:
        raise _Unread from None


class _Insistent:
    """Make an interrupt arrive: as :class:`_Interrupted`, whatever a library in between makes of
    it.

    CasADi clears exceptions while it tries which of its overloads fits, so an interrupt at that
    moment is lost, or comes back as another error. So it waits a little for CasADi to come back, is
    repeated every second until it arrives, and what fails after it is taken for it.
    """

    def __enter__(self) -> None:
        self._noticed = threading.Event()
        self._waits, self._process = itertools.count(1), os.getpid()
        self._able = threading.current_thread() is threading.main_thread() and hasattr(
            signal, "setitimer"
        )
        # What Python ignores, as in a callback of a weak reference, arrives a second later, and is
        # no one's concern.
        self._ignored = sys.unraisablehook
        sys.unraisablehook = lambda ignored: (
            None if issubclass(ignored.exc_type, KeyboardInterrupt) else self._ignored(ignored)
        )
        caught = (*interrupts(), signal.SIGALRM) if self._able else ()
        self._before = [(number, signal.signal(number, self._interrupt)) for number in caught]

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        sys.unraisablehook = self._ignored
        if self._able:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        for number, handler in self._before:
            signal.signal(number, handler)
        if kind is not None and (
            issubclass(kind, KeyboardInterrupt)
            or (issubclass(kind, Exception) and self._noticed.is_set())
        ):
            raise _Interrupted from None

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        if os.getpid() != self._process:  # a case may have others work for it: they end as they do
            signal.signal(number, signal.SIG_DFL)
            os.kill(os.getpid(), number)
            return
        self._noticed.set()
        callers = [caller for caller, _ in traceback.walk_stack(frame)]
        packages = {caller.f_globals.get("__name__", "").partition(".")[0] for caller in callers}
        if any(caller.f_code is _Insistent.__exit__.__code__ for caller in callers):
            return  # it has arrived
        if "casadi" in packages and next(self._waits) % _WAITS:
            signal.setitimer(signal.ITIMER_REAL, _MOMENT)
            return
        signal.setitimer(signal.ITIMER_REAL, 1.0)
        raise KeyboardInterrupt


def _fail(message: str, status: int, *more: str) -> int:
    for keyword, option in _OPTIONS.items():
        message = message.replace(keyword, option)
    _say(f"error: {' '.join(message.split())}", *more)
    return status


def _say(*lines: str) -> None:
    with suppress(OSError):  # the terminal may be gone
        echo(*lines, err=True)
