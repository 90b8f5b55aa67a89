"""An exported folder tests itself, and a program in C++17 that uses the folder alone has the
numbers of the API over a cycle. A program in C99 does so for all scenes, in test_every_way.
"""

import shutil
import subprocess

import pytest
from exported import (
    CONSUMERS,
    RATIOS,
    compare,
    expected,
    exported,
    instants,
    run,
    solve,
)
from mechanisms import (
    slider_crank,
)

from lagrange_casadi import export, load_case


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
    scene = load_case(name).scene
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
