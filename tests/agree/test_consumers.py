"""Programs that use an exported folder alone, in C++17 against the API over a cycle; and on other
rungs one in C99, which test_every_way uses for all scenes.
"""

import shutil
import subprocess

import pytest
from exported import (
    CONSUMERS,
    FEW,
    RATIOS,
    by_c99,
    compare,
    expected,
    exported,
    instants,
    run,
    solve,
    values,
)
from mechanisms import (
    slider_crank,
    truss_platform,
)
from stepped import iterated

from lagrange_casadi import export, load_case

SCENES = {
    name: lambda name=name: load_case(name).scene
    for name in ("slider_crank", "beam_pump", "quick_return", "rrr3")
} | {"iterated": iterated, "truss_platform": truss_platform}


@pytest.mark.sampled(9)
@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize(
    ("name", "method"),
    [
        ("iterated", {"newton": 2}),
        ("rrr3", {"newton": 3}),
        ("slider_crank", {"table": 64}),
        ("beam_pump", {"newton": 2}),
    ],
)
def test_on_other_rungs_too(name, method, precision, tmp_path):
    scene = SCENES[name]()
    made, told = exported(
        scene, tmp_path, precision=precision, parameters=values(scene, precision), **method
    )
    solution = solve(scene, precision, **method)
    found = by_c99(tmp_path, told, instants(solution.t, precision))
    # Before counted steps the API closes the loops in doubles, the program in its own precision:
    # other roundings from there on.
    apart = {"exact": False, "few": 4 * FEW} if "newton" in method else {}
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
    result = subprocess.run(
        ["ctest", "--test-dir", build, "--output-on-failure"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stdout
    assert result.stdout.count("Passed") == 2


@pytest.mark.long
@needs_cmake
@pytest.mark.parametrize("name", ["slider_crank", "quick_return", "rrr3"])
def test_a_cpp17_program_finds_the_package(name, tmp_path):
    scene = SCENES[name]()
    made, told = exported(scene, tmp_path / "exported")
    build, prefix = built(tmp_path / "exported", "-DBUILD_TESTING=OFF"), tmp_path / "installed"
    subprocess.run(
        ["cmake", "--install", build, "--prefix", prefix], check=True, capture_output=True
    )
    shutil.move(tmp_path / "exported" / "names.h", tmp_path)
    shutil.rmtree(tmp_path / "exported")
    options = [
        f"-DCMAKE_PREFIX_PATH={prefix}",
        f"-DMECHANISM={told['prefix']}",
        f"-DNAMES={tmp_path}/names.h",
    ]
    where = ["-S", CONSUMERS / "cpp17", "-B", tmp_path / "consumer"]
    subprocess.run(["cmake", *where, *options], check=True, capture_output=True)
    subprocess.run(["cmake", "--build", tmp_path / "consumer"], check=True, capture_output=True)
    solution = solve(scene, "double")
    found = run(
        [tmp_path / "consumer" / "consumer", *map(str, RATIOS)], instants(solution.t, "double")
    )
    compare(found, expected(scene, told, solution), told, made, solution)
