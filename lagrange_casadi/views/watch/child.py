"""The process that runs a case once, and says line by line what it finds: whatever the case does,
an endless loop, a crash, too much memory, ends this process and no other.

It imports the program before there is anything to run.
"""

from __future__ import annotations

import json
import os
import sys
import threading
import warnings
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from importlib.util import source_from_cache
from pathlib import Path
from typing import Any, TypeAlias

from ...base.apart import limit_memory
from ...errors import LagrangeCasadiError, PostureError, one_line
from ...model.scene import Scene
from ...studies import solving  # noqa: F401 - which takes long to import
from ...studies.case import case_file, load_case
from ...studies.evaluate import evaluate
from ..drawing import draw_declared, draw_error
from ..figures.posture_figures import draw_postures, numbered
from ..report.live import Live, run_of
from ..report.page import with_motion
from ..report.page_contents import contents
from ..shapes.vector import svg

_MEMORY = 8e9
"""Bytes that a case may take at most."""

Say: TypeAlias = Callable[[str, object], None]


def main() -> None:
    """Read a case and how it is run from standard input, and write what is found to standard
    output; what the case itself prints goes to standard error.

    It ends with standard input, which is open as long as the program that wants to know.
    """
    with os.fdopen(os.dup(1), "w", encoding="utf-8") as out:
        os.dup2(2, 1)
        order = sys.stdin.readline()
        if not order:
            return
        limit_memory(_MEMORY)
        threading.Thread(target=_end_with_input, daemon=True).start()

        def say(kind: str, value: object) -> None:
            print(json.dumps([kind, value], allow_nan=False), file=out, flush=True)

        say("error", _shown(json.loads(order), say))


def _end_with_input() -> None:
    os.read(0, 1)  # which holds no lock that Python waits for at its end
    os._exit(1)


def _shown(given: Mapping[str, Any], say: Say) -> str:
    """Run a case; returns what is wrong with it, in words, else nothing."""
    # A file that is saved twice within a second may have the same time and size for Python.
    sys.dont_write_bytecode = True
    warnings.simplefilter("always", UserWarning)
    warnings.simplefilter("ignore", FutureWarning)
    warnings.showwarning = lambda message, *_args, **_more: say("note", str(message))
    try:
        _show(Path(given["case"]), given, say)
    except LagrangeCasadiError as error:
        with suppress(LagrangeCasadiError):
            if error.placement is not None:
                say("drawing", {"svg": draw_error(error).svg})
            elif isinstance(error, PostureError) and isinstance(error.scene, Scene):
                picture, postures, _ = draw_postures(error.scene)
                if picture is not None:
                    say("drawing", {"svg": svg(picture, paper=False)})
                    return "\n".join([str(error), *numbered(postures)])
        if isinstance(error.__cause__, MemoryError):
            return f"out of memory: the case takes more than there is ({error})"
        return str(error)
    except MemoryError as error:
        return f"out of memory: {str(error) or 'the case takes more than there is'}"
    except BaseException as error:
        return f"{type(error).__name__}: {one_line(error)}"
    return ""


def _show(case: Path, given: Mapping[str, Any], say: Say) -> None:
    """Say what a case looks like, how it moves, its forces, and what evaluates other designs."""
    say("doing", "loading the case")
    file = case_file(case).resolve()
    opened = _opened_in(file.parent)
    try:
        scene = load_case(case).scene
    except LagrangeCasadiError as error:
        if drawing := draw_declared(file, error):
            say("drawing", {"svg": drawing.svg})
        raise
    finally:
        say("files", sorted(opened))
    parameters, t = given["parameters"], given["t"]
    wanted = with_motion(given["wanted"] or scene.wanted)
    say("doing", "drawing")
    say("drawing", {"svg": scene.draw(parameters=parameters, t=t and t[0]).svg})
    say("doing", "computing the motion")
    run = partial(evaluate, scene, parameters=parameters, t=t, backend="vm")
    motion = contents(run(wanted=["motion"], certificate=False))
    say("contents", {"whole": False, "contents": motion})
    say("doing", "computing forces and peaks")
    solution = run(wanted=wanted)
    say("contents", {"whole": True, "contents": contents(solution)})
    # What elasticity determines is not in the program of a live page.
    if scene.values() and not solution.elasticity.completed:
        say("doing", "compiling for the browser")
        try:
            live = Live.of(scene, scene.timing(t), wanted, run_of(str(case)), parameters)
            say("contents", {"whole": True, "contents": contents(solution, live)})
        except LagrangeCasadiError as error:
            say("note", f"joints cannot be dragged: {one_line(error)}")


def _opened_in(folder: Path) -> set[str]:
    """The files in a folder that are opened from now on; of compiled modules their sources."""
    opened: set[str] = set()

    def hear(event: str, arguments: tuple[Any, ...]) -> None:
        if event == "open" and isinstance(arguments[0], str):
            path = os.path.abspath(arguments[0])
            if path.startswith(f"{folder}{os.sep}"):
                opened.add(source_from_cache(path) if path.endswith(".pyc") else path)

    sys.addaudithook(hear)
    return opened
