"""``lagrange-casadi watch``: a page in a browser that follows a case as its file is saved."""

from __future__ import annotations

import math
import webbrowser
from pathlib import Path
from typing import Any

from ..errors import StoreError
from ..studies.case import case_file, name_of
from ..views.watch import News, Server, follow, page
from .echo import echo
from .options import refuse


def watch(
    case: Path,
    *,
    port: int = 0,
    no_browser: bool = False,
    time_limit: float | None = None,
    **given: Any,
) -> None:
    """Open a page in a browser that follows CASE as its file is saved.

    Each time that the file is saved, or a module beside it, the page shows its drawing, then its
    motion, its forces and their peaks, or what is wrong with it. The case runs in a process of its
    own. Ctrl-C ends it.

    Parameters
    ----------
    case : CASE
    parameters, t
        As of :func:`.studies.evaluate.evaluate`.
    wanted
        As of :func:`.studies.evaluate.evaluate`: Compute these outputs: effort, reaction:JOINT,
        section:LINK, a kind such as section, or all; default: those of the case.
    port : NUMBER
        Serve the page on this port of this machine; default: any that is free.
    no_browser
        Write the page's address, and open no browser.
    time_limit : SECONDS
        End a run of the case after this time [s]; default: 20 to draw it, 600 in all.
    """
    refuse(
        (not 0 <= port < 65536, f"--port: expected a number from 0 to 65535, got {port}"),
        (
            time_limit is not None and not 0.0 < time_limit < math.inf,
            f"--time-limit: expected a positive number of seconds, got {time_limit}",
        ),
    )
    file = case_file(case).resolve()
    news = News()
    try:
        server = Server(*page(name_of(file)), news, port)
    except OSError as error:
        raise StoreError(f"--port {port}: {error.strerror}") from None
    with server:
        echo(f"{server.address} follows {file}; Ctrl-C ends it")
        if not no_browser:
            webbrowser.open(server.address)
        follow(case, given, news, time_limit)
