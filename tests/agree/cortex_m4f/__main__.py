"""``python tests cortex_m4f``: the sizes, the stack and the instructions of exported mechanisms
on a Cortex-M4F.
"""

import sys
import tempfile
from pathlib import Path

from lagrange_casadi.errors import LagrangeCasadiError

from .target import METHODS, exported, missing

CASES = (
    "slider_crank",
    "four_bar",
    "andrews_squeezer",
    "rrr3",
    "spatial_slider_crank",
    "arm6",
    "five_link_suspension",
)


def row(name, method, optimized, folder):
    """A line of the table."""
    found = exported(name, method, folder, optimized)
    found.selftest()
    own, whole, n = found.sections(found.object), found.sections(found.whole), found.measured
    library = sum(whole.values()) - sum(own.values())
    stack = max(value for key, value in n.items() if key.startswith("stack"))
    numbers = [
        len(found.contract.outputs),
        own["text"],
        own["rodata"],
        library,
        n["bytes model"],
        stack,
        found.stated,
    ]
    return [
        name,
        method,
        optimized,
        *numbers,
        n["instructions evaluate"],
        n["instructions worst"],
        n.get("instructions section", ""),
    ]


def main():
    """Print the table, in Markdown."""
    if missing():
        sys.exit(f"nothing can be measured: {missing()}")
    titles = (
        "case",
        "rung",
        "",
        "outputs",
        "code",
        "constants",
        "of libraries",
        "model",
        "stack",
        "stack stated",
        "evaluate",
        "worst",
    )
    print("| " + " | ".join((*titles, "section")) + " |")
    print("| --- " * 3 + "| --: " * 10 + "|")
    with tempfile.TemporaryDirectory() as work:
        for name in CASES:
            for number, (method, optimized) in enumerate(
                (method, o) for method in METHODS for o in ("-O2", "-Os")
            ):
                try:
                    cells = row(name, method, optimized, Path(work) / f"{name}_{number}")
                except LagrangeCasadiError as reason:
                    print(f"| {name} | {method} | {optimized} | {reason} |")
                    continue
                print("| " + " | ".join(map(str, cells)) + " |", flush=True)


if __name__ == "__main__":
    main()
