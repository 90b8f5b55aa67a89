"""The stack that compiled C takes: what a compiler says of each function, along the deepest calls
in its assembly.
"""

import functools
import re
import subprocess

_FUNCTION = re.compile(r"^\s+\.type\s+([\w.$]+),\s*[@%]function$", re.MULTILINE)
_CALL = re.compile(
    r"^\s+(?:call|callq|jmp|bl|b|b\.w)\s+([A-Za-z_][\w.$]*)(?:@PLT)?\s*(?:[#@].*)?$", re.MULTILINE
)


def variant(name):
    """A function's name without the numbers of parts and variants of it, which not every listing
    gives.
    """
    return re.sub(r"\.(cold|\d+)(?=\.|$)", "", name)


def frames(command, source, folder):
    """Of each function of a source: the bytes of its frame, and which functions it calls.

    A return address that a call pushes is counted, for not every compiler does. A frame must be
    known, or bounded, beforehand.
    """
    assembly = folder / f"{source.stem}.s"
    subprocess.run(
        [*command, "-S", "-fstack-usage", source, "-o", assembly],
        check=True,
        cwd=folder,
        capture_output=True,
        text=True,
    )
    pushed = 0 if command[0].startswith("arm-none-eabi") else 8
    found = {}
    for line in assembly.with_suffix(".su").read_text().splitlines():
        place, size, kind = line.split("\t")
        assert kind in ("static", "dynamic,bounded"), line
        name = variant(place.rsplit(":", 1)[1])
        found[name] = (max(int(size) + pushed, found.get(name, (0,))[0]), set())
    before, *parts = _FUNCTION.split(assembly.read_text())
    assert not _CALL.search(before)
    for name, text in zip(parts[::2], parts[1::2], strict=True):
        found[variant(name)][1].update(variant(other) for other in _CALL.findall(text))
    assert all(name not in called for name, (_, called) in found.items()), "a function calls itself"
    return found


def deepest(command, source, folder):
    """Bytes of stack that a call of any function of a source takes at most, without what a
    library's functions take.
    """
    found = frames(command, source, folder)

    @functools.cache
    def depth(name):
        size, called = found[name]
        return size + max((depth(other) for other in called & found.keys()), default=0)

    return max(depth(name) for name in found)
