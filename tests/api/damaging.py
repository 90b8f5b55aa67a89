"""Damage drawn at random."""

from __future__ import annotations

import random

from internals import opening

LARGEST = 1 << 13


def damaged(content: bytes, chance: random.Random) -> bytes:
    """The content with one thing wrong."""
    size = len(content)
    # Half of all damage is near the ends, where a file says what it is.
    at = chance.choice(
        [
            chance.randrange(size),
            chance.randrange(min(size, 2048)),
            size - 1 - chance.randrange(min(size, 2 * opening.SIZE)),
        ]
    )
    other = chance.randrange(size)
    long = int(LARGEST ** chance.random())
    zeros = bytes(long)
    noise = chance.randbytes(long)
    kinds = [
        lambda: content[:at] + bytes([content[at] ^ 1 << chance.randrange(8)]) + content[at + 1 :],
        lambda: content[:at] + bytes([chance.randrange(256)]) + content[at + 1 :],
        lambda: content[:at] + noise + content[at + long :],
        lambda: content[:at] + zeros + content[at + long :],
        lambda: content[:at] + content[other : other + long] + content[at + long :],
        lambda: swapped(content, at, other, long),
        lambda: content[:at],
        lambda: content[at:],
        lambda: content[:at] + content[at + long :],
        lambda: content[:at] + noise + content[at:],
        lambda: content + noise,
        lambda: content + zeros,
        lambda: content + content[-long:],
        lambda: content[: -opening.SIZE],
        lambda: content[: -opening.SIZE] + content,
        lambda: b"",
    ]
    return chance.choice(kinds)()


def swapped(content: bytes, one: int, other: int, long: int) -> bytes:
    """Two blocks of a content in each other's place."""
    first, second = sorted((one, other))
    long = min(long, second - first, len(content) - second)
    a, b = content[first : first + long], content[second : second + long]
    return content[:first] + b + content[first + long : second] + a + content[second + long :]
