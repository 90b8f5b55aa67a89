"""Folders that are filled once more: a manifest tells which files there are ours, with a digest of each."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

from ..errors import PathError
from .publish import telling


@dataclass(frozen=True)
class Manifest:
    """A kind of manifest: its file's name and schema, and in words what is done, what was, and the way out."""

    name: str
    schema: str
    does: str
    earlier: str
    way_out: str

    def known(self, folder: Path) -> dict[str, str]:
        """Files that an earlier time wrote, and their digests; none where there is no manifest of this kind."""
        try:
            content = json.loads((folder / self.name).read_text(encoding="utf-8"))
            files = content["files"] if content["schema"] == self.schema else {}
            return {str(name): str(digest) for name, digest in files.items()}
        except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
            return {}

    def check(
        self, folder: Path, files: Collection[str] = (), *, beside: bool | None = None, changed: bool = False, apart: str = ""
    ) -> dict[str, str]:
        """The files that an earlier time wrote and nobody changed, and their digests, if ``files`` may be written.

        Other files may be there if ``beside``, by default if there is a manifest; hidden ones, and the one ``apart``, always. What
        was changed since may be replaced if ``changed``. Raises :class:`PathError` else, and for a name in ``files`` that a file
        of somebody else has.
        """
        if not folder.exists():
            return {}
        with telling(folder):
            known = self.known(folder)
            present = {path.name for path in folder.iterdir() if not path.name.startswith(".")}
            present -= {apart, *([self.name] if known else [])}
            files_there = [folder / name for name in present & known.keys()]
            found = {path.name: digest(path) for path in files_there if path.is_file() and not path.is_symlink()}
        same = {name: found[name] for name in sorted(found) if found[name] == known[name]}
        foreign, touched = sorted(present - known.keys()), sorted(present & known.keys() - same.keys())
        refused = f"cannot {self.does} {folder}:"
        for name in foreign:
            if name in files or name == self.name:
                raise PathError(f"{refused} '{name}' there is no file of {self.earlier}; move it, or choose another folder")
        if foreign and not (bool(known) if beside is None else beside):
            raise PathError(f"{refused} it holds other files, '{foreign[0]}' among them; {self.way_out}")
        if touched and not changed:
            raise PathError(f"{refused} it holds {self.earlier} whose '{touched[0]}' was changed since; {self.way_out}")
        return same

    def text(self, files: Mapping[str, str], more: Mapping[str, object] | None = None) -> str:
        """The manifest of files by their digests, with what ``more`` it tells."""
        content = {"schema": self.schema, "schema_version": 1, **(more or {}), "files": dict(sorted(files.items()))}
        return json.dumps(content, indent=1) + "\n"

    def add(self, draft: Path, folder: Path) -> None:
        """Put the manifest beside the files of a ``draft`` that go into ``folder``; what is ours there stays known.

        Raises :class:`PathError` for a name that is taken, or a file that was changed since.
        """
        written = {path.name: digest(path) for path in draft.iterdir()}
        same = self.check(folder, written)
        (draft / self.name).write_text(self.text(same | written), encoding="utf-8", newline="\n")


def digest(file: Path | bytes) -> str:
    """The SHA-256 of a file, or of bytes. Raises ``OSError``."""
    return hashlib.sha256(file if isinstance(file, bytes) else file.read_bytes()).hexdigest()
