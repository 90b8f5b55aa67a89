"""Damage counted step by step in C, in bounded memory, against rainflow counting of the whole
history.
"""

import math
import subprocess

import numpy as np
import pytest
from internals import counter, cycles, rainflow, reversed_amplitude
from strong import STEEL, slider

from lagrange_casadi import codegen, export

MATERIALS = {
    "lasting": STEEL.but(endurance=200e6),
    "worn": STEEL.but(endurance=150e6, endless=False),
}
STRICT = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror"]
PROGRAM = """
#include "x_fatigue.h"
#include <stdio.h>
int main(void) {
  const x_fatigue_material materials[] = {X_FATIGUE_OF_LASTING, X_FATIGUE_OF_WORN};
  long many;
  while (scanf("%ld", &many) == 1) {
    int k;
    long i;
    x_fatigue counters[] = {{{0}, 0, 0.0, 0.0}, {{0}, 0, 0.0, 0.0}};
    for (i = 0; i < many; ++i) {
      double stress;
      if (scanf("%lf", &stress) != 1) return 1;
      for (k = 0; k < 2; ++k) x_fatigue_add(&counters[k], &materials[k], stress);
    }
    for (k = 0; k < 2; ++k) printf("%.17g ", x_fatigue_damage(&counters[k], &materials[k]));
    printf("%.17g %.17g\\n", counters[0].swings, counters[0].damage);
  }
  return 0;
}
"""


@pytest.fixture(scope="module")
def count(tmp_path_factory):
    """Damage of histories by both materials, and swings and damage of those that have closed."""
    made = {}

    def built(depth):
        folder = tmp_path_factory.mktemp("counting")
        (folder / "x_fatigue.h").write_text(counter("x", MATERIALS))
        (folder / "x.c").write_text(PROGRAM)
        compiler = codegen.find_compiler("c")
        flags = [f"-DX_FATIGUE_DEPTH={depth}"] if depth else []
        subprocess.run(
            [*compiler.command, *STRICT, *flags, folder / "x.c", "-o", folder / "x", "-lm"],
            check=True,
        )
        return folder / "x"

    def run(histories, depth=0):
        program = made.setdefault(depth, None) or built(depth)
        made[depth] = program
        text = "\n".join(
            f"{len(one)} " + " ".join(float(x).hex() for x in one) for one in histories
        )
        done = subprocess.run([program], input=text, capture_output=True, text=True, check=True)
        return [list(map(float, line.split())) for line in done.stdout.splitlines()]

    return run


def damage(history, material):
    """Miner's sum over the swings of a whole history."""
    swings = rainflow(history)
    sizes = reversed_amplitude([s.size / 2 for s in swings], [s.mean for s in swings], material)
    with np.errstate(divide="ignore"):
        return float(np.sum(np.array([s.times for s in swings]) / cycles(sizes, material)))


def histories(rng):
    """Walks, noise, steps that repeat, sequences that grow and that die away, and short ones."""
    yield from ([], [1e8], [1e8, 1e8], [0.0, 5e8, 5e8, -3e8], [0.0, 6.5e8, 0.0, 6.5e8])
    for _ in range(60):
        size = int(rng.integers(2, 400))
        yield np.cumsum(rng.normal(size=size)) * 6e7
        yield rng.normal(size=size) * 1.5e8
        yield np.round(rng.normal(size=size)) * 1e8
    for ratio in (0.97, 1 / 0.97):
        yield 3e8 * ratio ** np.arange(25) * (-1.0) ** np.arange(25)


def test_damage_is_that_of_the_whole_history(count):
    every = list(histories(np.random.default_rng(21)))
    for history, found in zip(every, count(every), strict=True):
        told = [
            damage(history, material) if len(history) else 0.0 for material in MATERIALS.values()
        ]
        assert found[:2] == pytest.approx(told, rel=1e-10)
        assert found[3] <= found[0] * (1.0 + 1e-12)


def test_a_residue_that_is_too_deep_gives_up_its_oldest_swings(count):
    """One that dies away is counted as before, for each of its swings counts half at last."""
    history = 4e8 * 0.99 ** np.arange(200) * (-1.0) ** np.arange(200)
    deep, shallow = (count([history], depth)[0] for depth in (0, 8))
    told = [damage(history, material) for material in MATERIALS.values()]
    assert deep[:2] == pytest.approx(told, rel=1e-10)
    assert shallow[:2] == pytest.approx(told, rel=1e-10)
    # Where swings grow again, half of what was given up is missing.
    again = np.concatenate([history, history[::-1]])
    told = damage(again, MATERIALS["worn"])
    assert told / 2 <= count([again], 8)[0][1] < told * (1.0 + 1e-10)


def test_what_is_no_number_is_passed_over(count):
    history = [0.0, 5e8, -3e8, 4e8]
    (clean,), (dirty,) = (
        count([history]),
        count([[0.0, math.nan, 5e8, math.inf, -3e8, -math.inf, 4e8]]),
    )
    assert clean == dirty


def test_exports_have_it_where_strength_is_wanted(tmp_path):
    export(slider(200e6), tmp_path / "a", wanted=["safety:rod"])
    assert "SLIDER_FATIGUE_OF_ROD" in (tmp_path / "a" / "slider_fatigue.h").read_text()
    export(slider(), tmp_path / "b", wanted=["safety:rod"])
    export(slider(200e6), tmp_path / "c", wanted=["section:rod"])
    assert not [*tmp_path.glob("[bc]/*fatigue*")]
