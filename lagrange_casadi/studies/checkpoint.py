"""The finished parts of a long study: a folder beside its file, so that the study goes on after a
kill to the same bytes.

A part is a file of the folder, there whole or not at all, and being there it is done. It begins
with the SHA-256 of the study's identity, the part's name and what follows: a part of another study,
or a damaged one, is none.
"""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypedDict

from ..base.files import LOCK, check_writable, digest, held, reporting, settled, writing
from ..errors import BusyError, DeclarationError, PathError, StoreError, one_line
from ..results.store.untrusted import parsed

_PLAN, _PART = "plan.json", ".part"
_OURS = re.compile(rf"{_PLAN}|{LOCK}|\..*|[0-9a-f-]+{_PART}")
"""Names in the folder; those of drafts begin with a point."""


class Begun(TypedDict):
    """A study that was begun: its kind, whether it was ``forced`` to replace what was there, and
    its identity.
    """

    study: str
    forced: bool
    identity: Mapping[str, Any]


@dataclass(frozen=True)
class Checkpoint:
    """The folder of a ``study``, a sweep or a search, into the file ``target``."""

    target: Path
    study: str

    @classmethod
    def of(cls, target: Path, study: str) -> Checkpoint:
        """Resolve a path, so that a symbolic link stays one."""
        return cls(settled(target), study)

    @property
    def path(self) -> Path:
        """Path of the folder."""
        return self.target.with_name(f"{self.target.name}.parts")

    @property
    def begun(self) -> bool:
        """True if a study was begun here."""
        return os.path.isfile(self.path / _PLAN)  # of a name that is too long too

    @property
    def plan(self) -> Begun:
        """The study that was begun.

        Raises :class:`StoreError` if it cannot be read.
        """
        try:
            found: Begun = parsed((self.path / _PLAN).read_bytes(), Begun, "plan")
        except (OSError, ValueError) as error:
            raise StoreError(
                f"{self.path / _PLAN}: damaged: {one_line(error)}; start anew with force=True"
            ) from None
        return found

    @property
    def parts(self) -> list[str]:
        """Names of the parts, in order."""
        return sorted(path.stem for path in self.path.glob(f"*{_PART}"))

    @contextmanager
    def opened(self, identity: Mapping[str, Any], *, resume: bool, force: bool) -> Iterator[None]:
        """Hold the folder, made where it is not, and removed where no part is left in it.

        ``resume`` goes on with the parts that are there, ``force`` starts anew. Raises
        :class:`PathError` where parts are there and neither is asked for, :class:`StoreError` where
        they are of another study, :class:`BusyError` where another process holds the folder.
        """
        check_resuming(resume, force)
        check_writable(self.target, hdf5=True)
        with ExitStack() as stack:
            with reporting(self.target):
                self._refuse_foreign()
                try:
                    stack.enter_context(held(self.path))
                except BlockingIOError:
                    raise BusyError(
                        f"another {self.study} is writing {self.target}: wait for it, or write"
                        " another file"
                    ) from None
            try:
                self._begin(identity, resume, force)
                yield
            finally:
                if not self.parts:
                    self.clear()
                    shutil.rmtree(self.path, ignore_errors=True)

    def _refuse_foreign(self) -> None:
        """Raise :class:`PathError` where the folder holds what no study put there."""
        for name in sorted(os.listdir(self.path)) if self.path.is_dir() else ():
            if not _OURS.fullmatch(name):
                raise PathError(
                    f"{self.path} holds '{name}', which is not part of a {self.study}: move it, or"
                    " write to another file"
                )

    def _begin(self, identity: Mapping[str, Any], resume: bool, force: bool) -> None:
        """Go on with the study that is there, if it is the same; else begin it."""
        if self.begun and not force:
            if not resume:
                raise PathError(
                    f"{self.path} holds an unfinished {self.study}: continue with resume=True, or"
                    " start anew with force=True"
                )
            plan = self.plan
            before = {"study": plan["study"], **plan["identity"]}
            self.refuse_other(self.path, before, {"study": self.study, **identity})
            return
        if self.parts and not force:
            raise PathError(
                f"{self.path} holds parts, and no {_PLAN} that describes them: force=True starts"
                " anew"
            )
        self.clear()
        plan = {"study": self.study, "forced": force, "identity": identity}
        with writing(self.path / _PLAN) as file:
            file.write(json.dumps(plan, indent=1).encode())

    def refuse_other(self, place: Path, before: object, identity: object) -> None:
        """Raise :class:`StoreError` where what is in a place has another identity."""
        if found := difference(before, identity):
            raise StoreError(
                f"{place} is of another {self.study}: {found}; start anew with force=True, or write"
                " another file"
            )

    def commit(self, name: str, pieces: Sequence[bytes]) -> None:
        """Make a part: on return it outlives a kill and a loss of power.

        Raises :class:`StoreError` where that fails.
        """
        with writing(self.path_of(name)) as file:
            file.writelines([self._head(name, pieces), *pieces])

    def read(self, name: str) -> bytes | None:
        """The contents of a part; None where there is none, or none that is whole."""
        try:
            with self.path_of(name).open("rb") as file:
                head, content = file.readline(), file.read()
        except OSError:
            return None
        return content if head == self._head(name, [content]) else None

    def path_of(self, name: str) -> Path:
        """Path of a part."""
        return self.path / f"{name}{_PART}"

    def clear(self) -> None:
        """Remove the parts, and then the plan: while it is there the next run ends the removal."""
        with suppress(OSError):
            for path in sorted(self.path.iterdir(), key=lambda path: path.name == _PLAN):
                if path.is_dir():
                    shutil.rmtree(path)
                elif path.name != LOCK:
                    path.unlink()

    def _head(self, name: str, pieces: Sequence[bytes]) -> bytes:
        return f"{digest(f'{self._key} {name} '.encode(), *pieces)}\n".encode()

    @cached_property
    def _key(self) -> str:
        return digest(json.dumps(self.plan["identity"]).encode())


def check_resuming(resume: bool, force: bool) -> None:
    """Raise :class:`DeclarationError` for both."""
    if resume and force:
        raise DeclarationError(
            "resume and force exclude each other: continue with what is there, or start anew"
        )


def difference(before: object, now: object, where: str = "") -> str | None:
    """The first place at which two identities differ, in words; None where they do not."""
    if isinstance(before, dict) and isinstance(now, dict):
        for key in dict.fromkeys([*before, *now]):
            place = f"{where} {key}".strip()
            if key not in before or key not in now:
                return (
                    f"{place} was {'not there' if key not in before else 'there'}, and"
                    f" {'is' if key in now else 'is not'}"
                )
            found = difference(before[key], now[key], place)
            if found:
                return found
        if where == "grid" and list(before) != list(now):
            return f"the axes of the grid were {', '.join(before)} and are {', '.join(now)}"
        return None
    if before == now:
        return None
    if where in ("sources", "scene"):
        what = {
            "sources": "the program's own code",
            "scene": "an expression, a law of motion or the posture of the scene",
        }[where]
        return f"{what} has changed"
    return f"{where} was {_short(before)} and is {_short(now)}"


def _short(value: object) -> str:
    return value if isinstance(value, str) else json.dumps(value)
