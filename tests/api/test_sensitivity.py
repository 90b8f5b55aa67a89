"""Derivatives by parameters: beside differences in 50 digits, and beside closed forms."""

import itertools
import math

import numpy as np
import pytest
from balance import columns_at
from conftest import CASES, PLANAR, SPATIAL
from internals import FORCES, EvaluationMethod, Output, Sharpness, Slopes, at_instants, unit_ways
from parametric import declared
from precise import precise
from truth import truth

from lagrange_casadi import derive, load_case

RATIOS = (0.1234567, 0.9034567)
STEP = 2.0**-20
OWN = {
    "beam_pump": ["r", "counterweight", "fluid"],
    "jansen_leg": ["push"],
    "roller_cam": ["lift", "base", "offset", "stiffness"],
}
"""Cases of which the oracle knows some lengths by number, as where a spring acts: parameters of
theirs that change no drive.
"""


def made(scene, backend="vm"):
    """The slopes of all that a scene has, sections at the end."""
    program = derive(scene, ["all"])
    quantities = [output for output in program.outputs if not output.along]
    quantities += [Output("section", link, force) for link in program.links for force in FORCES]
    return Slopes.of(program, quantities, Sharpness.of(program, []), EvaluationMethod(backend))


def slopes_at(slopes, t, p):
    """Of every quantity at a time, and of every section force at ratios: value and slopes, by name
    and ratio.
    """
    names = [
        (q, xi)
        for q in slopes.points.quantities
        for xi in (RATIOS if q.group == "section" else (math.nan,))
    ]
    chosen = np.array([slopes.numbers[q] for q, _ in names], np.intc)
    times = np.full(len(names), t)
    # Loops are followed to the time from the start.
    z = slopes.iterated(np.linspace(slopes.program.data.span[0], t, 20), p, times)
    found = slopes.at(times, z, p, chosen, np.array([xi for _, xi in names]))
    return {(str(q), xi): (found.value[k], found.slopes[k]) for k, (q, xi) in enumerate(names)}


def differences(scene, t, name, at=None, share=STEP):
    """The derivatives of all quantities by a parameter in 50 digits: by four values, at doubles
    exactly as far apart.
    """
    values_at = scene.mechanism.values(at)
    x = values_at[name]
    step = math.ldexp(share, math.frexp(x)[1])
    _, held = columns_at(derive(scene, ["all"]), t, values_at)
    values = {}
    for k in (-2, -1, 1, 2):
        moved = x + k * step
        assert (moved - x) / k == step
        found = precise(scene, t, held, parameters={**values_at, name: moved})
        for quantity, value in found.items():
            for xi in RATIOS if callable(value) else (math.nan,):
                values.setdefault((quantity, xi), {})[k] = value(xi) if callable(value) else value
    return {
        key: (8 * (v[1] - v[-1]) - (v[2] - v[-2])) / (12 * step)
        for key, v in values.items()
        if len(v) == 4
    }


def unit(name):
    group, _, *member = name.split(":")
    return (group, *(m for m in member if group in ("reaction", "section")))


@pytest.mark.sampled(11)
@pytest.mark.parametrize("name", PLANAR)
def test_slopes_are_those_of_differences_in_50_digits(name):
    """Of every force and every place, by numbers of the declaration: lengths, masses, densities,
    places, gravity.
    """
    scene = load_case(CASES / name).scene if name in OWN else declared(CASES / name)
    start, stop, _ = scene.t
    t = start + 0.37 * (stop - start)
    slopes = made(scene)
    parameters = list(scene.mechanism.parameters)
    p = np.array(list(scene.mechanism.values().values()))
    own = slopes_at(slopes, t, p)
    # What a parameter changes if it doubles, the one that changes most.
    sizes: dict[tuple, float] = {}
    for key, (_, row) in own.items():
        sizes[unit(key[0])] = max(sizes.get(unit(key[0]), 0.0), float(np.abs(row * p).max()))
    for parameter in OWN.get(name, parameters[:: max(1, len(parameters) // 2)]):
        j = parameters.index(parameter)
        exact = differences(scene, t, parameter)
        told = [key for key in exact if key in own]
        assert len(told) >= 6
        for key in told:
            gap = abs(float(own[key][1][j] - exact[key]))
            assert gap <= 1e-10 * sizes[unit(key[0])] / abs(p[j]), (
                key,
                parameter,
                gap,
                sizes[unit(key[0])],
            )


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", ["arm", "engine", "four_bar", "quick_return", "rrr3"])
def test_second_derivatives_too(name):
    """By two parameters at once, at a time and a place that stand still, beside differences of four
    values in 50 digits.
    """
    scene = load_case(CASES / name).scene if name in OWN else declared(CASES / name)
    start, stop, _ = scene.t
    t = start + 0.37 * (stop - start)
    values = scene.mechanism.values()
    p, (one, other) = (
        np.array(list(values.values())),
        [k for k, x in values.items() if x != 0.0][-2:],
    )
    slopes = made(scene)
    names = [
        (q, xi)
        for q in slopes.points.quantities
        for xi in (RATIOS if q.group == "section" else (math.nan,))
    ]
    chosen = np.array([slopes.numbers[q] for q, _ in names], np.intc)
    xi = np.array([xi for _, xi in names])
    times = np.full(chosen.size, t)
    z = slopes.iterated(np.linspace(start, t, 20), p, times)
    numbers = [list(values).index(name) for name in (one, other)]
    ways = unit_ways(numbers, p.size)
    found = slopes.bends(times, z, p, chosen, xi, None, ways).changes[:, 2:]
    found = found[:, :, [2 + number for number in numbers]]
    np.testing.assert_allclose(
        found[:, 0, 1], found[:, 1, 0], rtol=0, atol=1e-12 * np.abs(found).max()
    )
    _, held = columns_at(derive(scene, ["all"]), t, values)
    steps = [math.ldexp(2.0**-20, math.frexp(values[name])[1]) for name in (one, other)]
    corners = {}
    for a, b in itertools.product((-1, 1), (-1, 1)):
        at = {**values, one: values[one] + a * steps[0], other: values[other] + b * steps[1]}
        corners[a, b] = precise(scene, t, held, parameters=at)
    sizes: dict[tuple, float] = {}
    for (q, _), rows in zip(names, found, strict=True):
        sizes[unit(str(q))] = max(
            sizes.get(unit(str(q)), 0.0),
            float(np.abs(rows * np.outer(p[numbers], p[numbers])).max()),
        )
    told = [k for k, (q, _) in enumerate(names) if str(q) in corners[1, 1]]
    assert len(told) >= 6
    for k in told:
        q, place = str(names[k][0]), names[k][1]
        v = {
            ab: value[q](place) if callable(value[q]) else value[q] for ab, value in corners.items()
        }
        exact = float((v[1, 1] - v[1, -1] - v[-1, 1] + v[-1, -1]) / (4 * steps[0] * steps[1]))
        gap = abs(found[k, 0, 1] - exact) * abs(values[one] * values[other])
        assert gap <= 1e-10 * sizes[unit(q)] + 1e-14, (q, one, other, gap, sizes[unit(q)])


def with_parameters():
    """The cases in space that have parameters; Bricard's loop closes for
    its own proportions alone.
    """
    return [
        name
        for name in SPATIAL
        if name != "bricard" and load_case(CASES / name).scene.mechanism.parameters
    ]


@pytest.mark.sampled(6)
@pytest.mark.parametrize("name", with_parameters())
def test_in_space_too(name):
    """All columns, forward, beside differences of the graph itself in 50 digits: of loops that are
    closed anew.
    """
    scene = load_case(CASES / name).scene
    start, stop = scene.span
    t = start + 0.37 * (stop - start)
    program, parameters = derive(scene, ["all"]), list(scene.mechanism.parameters)
    values = scene.mechanism.values()
    p = np.array(list(values.values()))
    rows = list(program.outputs)
    kinds = [f"{row.group} {row.unit(program.data.kinds)}" for row in rows]
    instants = np.linspace(start, t, 40)
    found = at_instants(program, rows, instants, p, list(range(p.size)), EvaluationMethod("vm"))[-1]
    sizes: dict[str, float] = {}
    for kind, own in zip(kinds, found, strict=True):
        sizes[kind] = max(sizes.get(kind, 0.0), float(np.abs(own[1:] * p).max()))
    rounding = 1e-15 * max(sizes.values())  # of what is nothing
    for j, parameter in enumerate(parameters):
        x = values[parameter]
        step = math.ldexp(STEP, math.frexp(x)[1])
        assert (x + step) - x == step
        four = {k: truth(scene, [t], {parameter: x + k * step}).sides[0][0] for k in (-2, -1, 1, 2)}
        for row, kind, own in zip(rows, kinds, found, strict=True):
            v = {k: columns[str(row)] for k, columns in four.items()}
            exact = float((8 * (v[1] - v[-1]) - (v[2] - v[-2])) / (12 * step))
            gap = abs(own[1 + j] - exact) * abs(x)
            assert gap <= 1e-10 * sizes[kind] + rounding, (str(row), parameter, gap, sizes[kind])


@pytest.mark.parametrize("share", [1e-3, 1e-6])
def test_near_a_dead_centre(share):
    """The rod is longer than the crank by a share; where the crank is across, the sine of the
    transmission angle is its root.
    """
    scene = load_case(CASES / "slider_crank").scene
    t = next(t for t in np.linspace(*scene.t).tolist() if across(scene, t) > 0.999999)
    values = scene.mechanism.values({"r": 0.1, "l": 0.1 * (1.0 + share)})
    own = slopes_at(made(scene), t, np.array(list(values.values())))
    for name in ("r", "l", "m3"):
        j = list(values).index(name)
        exact = differences(scene, t, name, values, share=2.0**-40)
        largest = max(abs(float(x)) for key, x in exact.items() if key in own)
        assert largest > (1e3 if name != "m3" else 1.0)
        for key in (key for key in exact if key in own):
            size = max(abs(float(exact[key])), 1e-6 * largest)
            assert abs(float(own[key][1][j] - exact[key])) <= 1e-7 * size, (name, key)


def across(scene, t):
    return abs(math.sin(float(derive(scene).motion(t, list(scene.mechanism.values().values()))[0])))
