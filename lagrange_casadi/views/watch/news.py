"""News of a case: its state, its drawing, and the contents of its page, each the newest that there
is.
"""

from __future__ import annotations

import json
import threading
from typing import Any


class News:
    """Parts of a page by name, as JSON, in the order in which they came; others may wait for the
    next.

    Each part has the number of the save that it is of.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._parts: dict[str, tuple[int, str]] = {}
        self._number = 0
        self._state: dict[str, Any] = {"save": 0}

    def begin(self) -> None:
        """A file was saved."""
        save = self._state["save"] + 1
        self._state = {"save": save, "doing": "starting", "error": "", "notes": []}
        self._tell("state", self._state)

    def put(self, kind: str, value: Any) -> None:
        """Hear what a run of the case says: what it does, a note, a drawing, the contents of a page
        with the motion or with the whole; or at its end an error, which may be empty.
        """
        state = self._state
        if kind in ("drawing", "contents"):
            self._tell(kind, {"save": state["save"], **value})
        elif kind == "note":
            state["notes"].append(value)
        else:
            state |= {"doing": "", kind: value}
        self._tell("state", state)

    def _tell(self, name: str, value: object) -> None:
        text = json.dumps(value)
        with self._changed:
            self._number += 1
            self._parts.pop(name, None)
            self._parts[name] = (self._number, text)
            self._changed.notify_all()

    def after(self, number: int, seconds: float) -> tuple[int, list[tuple[str, str]]]:
        """Wait at most so long for parts after the first ``number``.

        Returns how many have come, and the names and texts of the newest ones.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._number > number, seconds)
            parts = [(name, text) for name, (at, text) in self._parts.items() if at > number]
            return self._number, parts
