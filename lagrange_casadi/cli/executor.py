"""The executor that ``--dask ADDRESS`` names."""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from ..base.packages import check_installed
from ..errors import ClusterError, DeclarationError, one_line, warn
from ..studies.sweep.workers import Executor

_ADDRESS = re.compile(r"(tcp|tls|ws|wss|ucx)://\S+:\d{1,5}/?")
_PATIENCE = 10.0
"""Seconds in which a scheduler must answer."""


@contextmanager
def executor_at(address: str) -> Iterator[Executor]:
    """A client of the Dask scheduler at an address.

    Raises :class:`ClusterError` where no scheduler answers.
    """
    if not _ADDRESS.fullmatch(address):
        raise DeclarationError(f"dask: expected an address like tcp://HOST:8786, got '{address}'")
    check_installed("distributed", "a cluster", "cluster")
    import dask

    # What Dask says at length is said here in a line.
    dask.config.set({"logging": {"distributed": "critical", "distributed.client": "critical"}})
    try:
        client: Any = importlib.import_module("distributed").Client(
            address, timeout=_PATIENCE, set_as_default=False
        )
    except (OSError, TypeError, ValueError, RuntimeError) as error:
        raise ClusterError(f"no Dask scheduler answers at {address}: {one_line(error)}") from None
    with client:
        if not client.nthreads():
            warn(f"the scheduler at {address} has no workers yet; waiting for some")
        yield client
