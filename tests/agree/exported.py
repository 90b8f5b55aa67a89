"""Programs that use an exported folder, and what they must print."""

import json
import subprocess
from pathlib import Path

import numpy as np

from lagrange_casadi import evaluate, export

CONSUMERS = Path(__file__).parent / "consumers"
RATIOS = (0.0, 0.3, 0.5, 1.0)
FORCES = ("axial", "shear", "bending")
FEW = 4
"""Units of the last place of the largest value, where the arithmetic is not the same."""


def exported(scene, folder, **options):
    """The folder of a scene, and what it says of itself."""
    made = export(scene, folder, **options)
    told = json.loads((folder / "export.json").read_text())
    (folder / "names.h").write_text(names(told))
    return made, told


def names(told):
    """What a consumer's macros expand to: the names that export.json tells."""
    p, single = told["prefix"], told["precision"] == "single"
    given = {
        "P": p,
        "OUTPUTS(X)": " ".join(f"X({row['name']})" for row in told["outputs"]),
        "LINKS(X)": " ".join(f"X({link['constant']})" for link in told["links"]),
        "PREPARE(model)": f"{p}_prepare(model{', 0' if told['parameters'] else ''})",
        "TIME(t, rest)": f"({p}_real) (t)" + (f", ({p}_real) (rest)" if single else ""),
    }
    return "".join(f"#define {word} {text}\n" for word, text in given.items())


def instants(t, precision):
    """Lines of what a consumer reads."""
    high = t.astype(np.float32).astype(float) if precision == "single" else t
    return "\n".join(f"{float(a)!r} {float(b)!r}" for a, b in zip(high, t - high, strict=True))


def rows(output):
    return np.array(
        [[float.fromhex(word) for word in line.split()] for line in output.splitlines()]
    )


def by_c99(folder, told, lines, flags=("-O1", "-ffp-contract=off")):
    program = folder / "consumer"
    defined = [f'-DMECHANISM="{told["prefix"]}.h"', '-DNAMES="names.h"', f"-I{folder}"]
    source = [CONSUMERS / "c99" / "main.c", folder / f"{told['prefix']}.c"]
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wno-error=long-long"]
    subprocess.run(["cc", *strict, *flags, *defined, *source, "-o", program, "-lm"], check=True)
    return run([program, *map(str, RATIOS)], lines)


def run(command, lines):
    return rows(
        subprocess.run(command, input=lines, capture_output=True, text=True, check=True).stdout
    )


def expected(scene, told, solution):
    """What the API has for the outputs, and for the forces of each link at each ratio."""
    columns = [solution.series[row["path"].replace("/", ":")] for row in told["outputs"]]
    for link in told["links"]:
        grids = [
            solution.section(link["name"]).law.on_grid(force, np.array(RATIOS)) for force in FORCES
        ]
        columns += [grid[:, k] for k in range(len(RATIOS)) for grid in grids]
    return np.stack(columns, axis=1)


def compare(found, wanted, told, made, solution, exact=True, few=FEW):
    """To the last bit, or within a few units of each column's largest; angles that loops set up to
    whole turns.
    """
    assert found.shape == wanted.shape
    turning = [k for k, member in enumerate(made.outputs) if member.wrapped]
    gaps = np.abs(found - wanted)
    gaps[:, turning] = np.abs(
        np.remainder(found[:, turning] - wanted[:, turning] + np.pi, 2 * np.pi) - np.pi
    )
    unit = np.finfo(np.float32 if told["precision"] == "single" else float).eps
    outputs = len(told["outputs"])
    alike = [k for k in range(outputs) if k not in turning] if exact else []
    np.testing.assert_array_equal(found[:, alike], wanted[:, alike])
    largest = np.abs(wanted).max(axis=0)
    # An angle has the digits of a turn; a force of a link those of the terms it is the sum of.
    largest[turning] = np.pi
    for start, link in zip(
        range(outputs, wanted.shape[1], 3 * len(RATIOS)), told["links"], strict=True
    ):
        for k, force in enumerate(FORCES):
            largest[start + k : start + 3 * len(RATIOS) : 3] = solution.section(
                link["name"]
            ).law.bound(force, np.array(RATIOS))
    units = (gaps / (unit * largest + np.finfo(float).tiny)).max(axis=0)
    assert units.max() <= few, dict(
        zip([row["name"] for row in told["outputs"]], units, strict=False)
    )


def values(scene, precision):
    """The parameters as a precision holds them."""
    kind = np.float32 if precision == "single" else float
    return {name: float(kind(value)) for name, value in scene.mechanism.values().items()}


def solve(scene, precision, **method):
    """The API's numbers."""
    return evaluate(
        scene, parameters=values(scene, precision), precision=precision, backend="c", **method
    )
