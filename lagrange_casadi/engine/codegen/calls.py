"""Arguments of compiled code: a struct whose members Python sets by name and C reads by name.

One list of members makes both the C struct and the :class:`ctypes.Structure`, so neither depends on
an order that is written down twice.
"""

from __future__ import annotations

import ctypes
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from _ctypes import CFuncPtr

_NUMBERS = {"long long": ctypes.c_longlong, "int": ctypes.c_int, "double": ctypes.c_double}


@dataclass(frozen=True, eq=False)
class Call:
    """A struct of C: its ``name``, and the C type of each member.

    A type is ``long long``, ``int``, ``double`` or a pointer; ``real`` in it stands for a floating
    type that :meth:`text` is given, by default that of an emitted file.
    """

    name: str
    members: Mapping[str, str]

    def text(self, real: str = "lanes_real") -> str:
        """The definition in C, with the floating type ``real``."""
        lines = (
            f"  {kind}{'' if kind.endswith('*') else ' '}{name};\n"
            for name, kind in self.members.items()
        )
        return (
            "typedef struct {\n" + re.sub(r"\breal\b", real, "".join(lines)) + f"}} {self.name};\n"
        )

    @cached_property
    def type(self) -> type[ctypes.Structure]:
        """Structure of ``ctypes``; pointers are addresses."""
        fields = [
            (name, ctypes.c_void_p if kind.endswith("*") else _NUMBERS[kind])
            for name, kind in self.members.items()
        ]
        # Without slots a member of another name would be taken for an attribute.
        return type(self.name, (ctypes.Structure,), {"__slots__": (), "_fields_": fields})

    def made(self, **values: float | None) -> ctypes.Structure:
        """The struct with all its members: numbers, addresses, None for NULL.

        Raises ``TypeError`` where one is missing, ``AttributeError`` for one that is unknown.
        """
        made = self.type(**values)
        if len(values) < len(self.members):
            raise TypeError(
                f"{self.name}: without"
                f" {', '.join(name for name in self.members if name not in values)}"
            )
        return made

    def declare(self, entry: CFuncPtr, *more: Any) -> CFuncPtr:
        """A function of a library that takes a pointer to this struct, then ``more``, and gives
        nothing: declared so, for :mod:`ctypes`.
        """
        entry.restype, entry.argtypes = None, [ctypes.POINTER(self.type), *more]
        return entry
