"""Three programs that use an exported folder alone, in C99, C++17 and Python, against the API over a cycle."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from mechanisms import DRAG_LINK, bracket, slider_crank, spline_arm, sprung, truss_platform

from lagrange_casadi import codegen, evaluate, export, load_case
from lagrange_casadi.quantities import FORCES

CONSUMERS = Path(__file__).parent / "consumers"
CASES = Path(__file__).parents[1] / "cases"
RATIOS = (0.0, 0.3, 0.5, 1.0)
FEW = 4
"""Units of the last place of the largest value, where the arithmetic is not the same."""

SCENES = {case.name: (lambda case=case: load_case(case).scene) for case in sorted(CASES.iterdir()) if case.is_dir()}
SCENES |= {
    "truss_platform": truss_platform,
    "spline_arm": spline_arm,
    "sprung": lambda: sprung("AC", **DRAG_LINK),
    "bracket": bracket,
}


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
    return np.array([[float.fromhex(word) for word in line.split()] for line in output.splitlines()])


def by_c99(folder, told, lines, flags=("-O1", "-ffp-contract=off")):
    compiler = codegen.find_compiler()
    program = folder / "consumer"
    defined = [f'-DMECHANISM="{told["prefix"]}.h"', '-DNAMES="names.h"', f"-I{folder}"]
    source = [CONSUMERS / "c99" / "main.c", folder / f"{told['prefix']}.c"]
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wno-error=long-long"]
    subprocess.run([*compiler.command, *strict, *flags, *defined, *source, "-o", program, "-lm"], check=True)
    return run([program, *map(str, RATIOS)], lines)


def run(command, lines):
    return rows(subprocess.run(command, input=lines, capture_output=True, text=True, check=True).stdout)


def expected(scene, told, solution):
    """What the API has for the outputs, and for the forces of each link at each ratio."""
    columns = [solution.series[row["path"].replace("/", ":")] for row in told["outputs"]]
    for link in told["links"]:
        grids = [solution.section(link["name"]).law.on_grid(force, np.array(RATIOS)) for force in FORCES]
        columns += [grid[:, k] for k in range(len(RATIOS)) for grid in grids]
    return np.stack(columns, axis=1)


def compare(found, wanted, told, made, solution, exact=True, few=FEW):
    """To the last bit, or within a few units of each column's largest; angles that loops set up to whole turns."""
    assert found.shape == wanted.shape
    turning = [k for k, member in enumerate(made.outputs) if member.wrapped]
    gaps = np.abs(found - wanted)
    gaps[:, turning] = np.abs(np.remainder(found[:, turning] - wanted[:, turning] + np.pi, 2 * np.pi) - np.pi)
    unit = np.finfo(np.float32 if told["precision"] == "single" else float).eps
    outputs = len(told["outputs"])
    alike = [k for k in range(outputs) if k not in turning] if exact else []
    np.testing.assert_array_equal(found[:, alike], wanted[:, alike])
    largest = np.abs(wanted).max(axis=0)
    # An angle has the digits of a turn; a force of a link those of the terms it is the sum of.
    largest[turning] = np.pi
    for start, link in zip(range(outputs, wanted.shape[1], 3 * len(RATIOS)), told["links"], strict=True):
        for k, force in enumerate(FORCES):
            largest[start + k : start + 3 * len(RATIOS) : 3] = solution.section(link["name"]).law.bound(force, np.array(RATIOS))
    units = (gaps / (unit * largest + np.finfo(float).tiny)).max(axis=0)
    assert units.max() <= few, dict(zip([row["name"] for row in told["outputs"]], units, strict=False))


def values(scene, precision):
    """The parameters as a precision holds them."""
    kind = np.float32 if precision == "single" else float
    return {name: float(kind(value)) for name, value in scene.mechanism.values().items()}


def solve(scene, precision, **rung):
    """The API's numbers."""
    return evaluate(scene, parameters=values(scene, precision), precision=precision, backend="c", **rung)


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("name", SCENES)
def test_a_c99_program_has_the_numbers_of_the_api(name, precision, tmp_path):
    scene = SCENES[name]()
    made, told = exported(scene, tmp_path, precision=precision)
    solution = solve(scene, precision)
    found = by_c99(tmp_path, told, instants(solution.t, precision))
    # Samples are read by cubics here, by recursion there: that moves an angle by two units, and forces by what follows.
    apart = {"exact": False, "few": 4 * FEW} if name == "spline_arm" else {}
    compare(found, expected(scene, told, solution), told, made, solution, **apart)


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize(
    ("name", "rung"),
    [("four_bar", {"newton": 2}), ("rrr3", {"newton": 3}), ("slider_crank", {"table": 64}), ("six_bar", {"newton": 2})],
)
def test_on_other_rungs_too(name, rung, precision, tmp_path):
    scene = SCENES[name]()
    made, told = exported(scene, tmp_path, precision=precision, parameters=values(scene, precision), **rung)
    solution = solve(scene, precision, **rung)
    found = by_c99(tmp_path, told, instants(solution.t, precision))
    # Before counted steps the API closes the loops in doubles, the program in its own precision: other roundings from there on.
    apart = {"exact": False, "few": 4 * FEW} if "newton" in rung else {}
    compare(found, expected(scene, told, solution), told, made, solution, **apart)


def built(folder, *options):
    """The folder's own CMake project, built."""
    build = folder / "build"
    subprocess.run(["cmake", "-S", folder, "-B", build, *options], check=True, capture_output=True)
    subprocess.run(["cmake", "--build", build], check=True, capture_output=True)
    return build


needs_cmake = pytest.mark.skipif(shutil.which("cmake") is None, reason="needs cmake")


@needs_cmake
def test_the_folder_tests_itself(tmp_path):
    export(slider_crank(), tmp_path)
    build = built(tmp_path)
    result = subprocess.run(["ctest", "--test-dir", build, "--output-on-failure"], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout
    assert result.stdout.count("Passed") == 2


@needs_cmake
@pytest.mark.parametrize("name", ["slider_crank", "quick_return", "rrr3"])
def test_a_cpp17_program_finds_the_package(name, tmp_path):
    scene = SCENES[name]()
    made, told = exported(scene, tmp_path / "exported")
    build, prefix = built(tmp_path / "exported", "-DBUILD_TESTING=OFF"), tmp_path / "installed"
    subprocess.run(["cmake", "--install", build, "--prefix", prefix], check=True, capture_output=True)
    shutil.move(tmp_path / "exported" / "names.h", tmp_path)
    shutil.rmtree(tmp_path / "exported")
    options = [f"-DCMAKE_PREFIX_PATH={prefix}", f"-DMECHANISM={told['prefix']}", f"-DNAMES={tmp_path}/names.h"]
    where = ["-S", CONSUMERS / "cpp17", "-B", tmp_path / "consumer"]
    subprocess.run(["cmake", *where, *options], check=True, capture_output=True)
    subprocess.run(["cmake", "--build", tmp_path / "consumer"], check=True, capture_output=True)
    solution = solve(scene, "double")
    found = run([tmp_path / "consumer" / "consumer", *map(str, RATIOS)], instants(solution.t, "double"))
    compare(found, expected(scene, told, solution), told, made, solution)


@needs_cmake
@pytest.mark.parametrize(
    ("name", "precision"), [("slider_crank", "double"), ("slider_crank", "single"), ("truss_platform", "double")]
)
def test_a_python_program_loads_the_shared_library(name, precision, tmp_path):
    scene = SCENES[name]()
    made, told = exported(scene, tmp_path, precision=precision)
    build = built(tmp_path, "-DBUILD_SHARED_LIBS=ON", "-DBUILD_TESTING=OFF")
    (library,) = build.glob(f"lib{told['prefix']}.so")
    solution = solve(scene, precision)
    command = [sys.executable, CONSUMERS / "python" / "main.py", tmp_path, library, *map(str, RATIOS)]
    found = run(command, instants(solution.t, precision))
    compare(found, expected(scene, told, solution), told, made, solution)
