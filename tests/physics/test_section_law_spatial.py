"""The law of a spatial link: against quadrature of its matter in three dimensions, and its
resultants' peaks.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from internals import (
    SPACE,
    NumericDensity,
    Output,
    Section,
    SectionLaw,
    SpatialPointLoad,
    grids,
    made_of,
)

from lagrange_casadi.errors import UnknownNameError

X = np.array([1.0, 0.0, 0.0])
LENGTH = 0.7
DENSITIES = {
    "even": NumericDensity((0.0, 1.0), ((1.3,),)),
    "tapered": NumericDensity((0.0, 1.0), ((2.0, -1.7),)),
    "in cells": NumericDensity((0.0, 0.4, 1.0), ((1.0, 2.0), (3.0, -1.0, -0.5))),
    "with a gap": NumericDensity((0.0, 0.3, 0.6, 1.0), ((2.0,), (0.0,), (0.5, 0.4, 3.0, -1.0))),
}
NAMES = ("axial", "shear_y", "shear_z", "torsion", "bending_y", "bending_z")
SIZES = {"shear": ("shear_y", "shear_z"), "bending": ("bending_y", "bending_z")}


class Link:
    """A slender link in motion at one instant, all vectors on its own axes, and what acts on it
    beyond its base.
    """

    def __init__(self, random, density, stations, spin=3.0):
        self.density = density
        self.acceleration, self.alpha, self.omega = random.normal(size=(3, 3)) * [
            [9.0],
            [12.0],
            [spin],
        ]
        self.tip = random.normal(size=(2, 3)) * [[40.0], [5.0]]
        self.stations = [
            (float(u), *(random.normal(size=(2, 3)) * [[30.0], [4.0]])) for u in stations
        ]

    def place_acceleration(self, x):
        """Less gravity, at a distance from the base: a_B + alpha x r + w x (w x r)."""
        r = x[:, None] * X
        return (
            self.acceleration
            + np.cross(self.alpha, r)
            + np.cross(self.omega, np.cross(self.omega, r))
        )

    def at(self, u, side="tip"):
        """The forces at a section, what holds the piece beyond it: by Gauss' rule over each cell,
        d'Alembert's principle.
        """
        l, here = LENGTH, u * LENGTH * X
        force, moment = self.tip[0].copy(), self.tip[1] + np.cross(l * X - here, self.tip[0])
        nodes, weights = np.polynomial.legendre.leggauss(12)
        for a, b, cell in zip(
            self.density.breaks, self.density.breaks[1:], self.density.cells, strict=False
        ):
            a = max(a, u)
            if a >= b:
                continue
            v = (a + b) / 2 + (b - a) / 2 * nodes
            mass = np.polynomial.polynomial.polyval(v, cell) * weights * (b - a) / 2
            pull = -mass[:, None] * self.place_acceleration(v * l)
            force += pull.sum(axis=0)
            moment += np.cross(v[:, None] * l * X - here, pull).sum(axis=0)
        for station, pull, couple in self.stations:
            at_base, at_tip = station <= 1e-12, station >= 1.0 - 1e-12
            if at_tip or (not at_base and (u < station or (side == "base" and u == station))):
                force += pull
                moment += couple + np.cross(station * l * X - here, pull)
        found = dict(zip(NAMES, (*force, moment[0], moment[1], moment[2]), strict=True))
        return found | {name: float(np.hypot(found[a], found[b])) for name, (a, b) in SIZES.items()}

    def coefficients(self):
        """F = F0 - mu0 a - mu1 gamma, with gamma = alpha x e + w x (w x e); M by its moments.

        Bending has the lever of F.
        """
        gamma = np.cross(self.alpha, X) + np.cross(self.omega, np.cross(self.omega, X))
        (n, fy, fz), a = zip(self.tip[0], -self.acceleration, -gamma, strict=True), self.tip[1]
        values = (*n, *fy, a[2], *fz, a[1], a[0])
        return dict(zip(SPACE.law, (np.array([value]) for value in values), strict=True))

    def loads(self):
        return tuple(
            SpatialPointLoad(f"load{i}", *(np.array([x]) for x in (u, *pull, *couple)))
            for i, (u, pull, couple) in enumerate(self.stations)
        )

    def law(self):
        return SectionLaw(LENGTH, self.density, self.coefficients(), self.loads())


def together(links):
    """One law over many instants, of the laws of each."""
    laws = [link.law() for link in links]
    coefficients = {
        name: np.concatenate([law.coefficients[name] for law in laws]) for name in SPACE.law
    }
    loads = tuple(
        SpatialPointLoad(
            "",
            *(
                np.concatenate([getattr(law.loads[i], name) for law in laws])
                for name in SPACE.place_first
            ),
        )
        for i in range(len(laws[0].loads))
    )
    return SectionLaw(LENGTH, laws[0].density, coefficients, loads)


def drawn(seed, density, count, stations=2, spin=3.0):
    random = np.random.default_rng(seed)
    return [
        Link(random, DENSITIES[density], random.uniform(0.05, 0.95, stations), spin)
        for _ in range(count)
    ]


SEEDS = st.integers(0, 2**32 - 1)
KINDS = st.sampled_from(sorted(DENSITIES))


@given(
    SEEDS,
    KINDS,
    st.lists(st.floats(0, 1), min_size=0, max_size=3),
    st.floats(0, 1),
    st.sampled_from(["tip", "base"]),
)
def test_forces_are_those_of_quadrature(seed, density, stations, u, side):
    link = Link(np.random.default_rng(seed), DENSITIES[density], stations)
    law = link.law()
    for place in (u, 0.0, 1.0, *stations):
        expected = link.at(place, side)
        for force in SPACE.forces:
            scale = 200.0 if expected[force] == 0.0 else 200.0 + abs(expected[force])
            assert (
                abs(law.at(force, np.array([[place]]), side)[0, 0] - expected[force])
                <= 1e-13 * scale
            ), force


@given(SEEDS, KINDS)
def test_the_tip_is_exact(seed, density):
    link = Link(np.random.default_rng(seed), DENSITIES[density], ())
    found = [link.law().on_grid(force, np.array([1.0]))[0, 0] for force in NAMES]
    assert found == [*link.tip[0], *link.tip[1]]


@pytest.mark.parametrize("density", DENSITIES)
@pytest.mark.parametrize("worth", [0, 10**12])
def test_grids_compiled_or_not_are_what_the_law_gives_at_each_point(density, worth, monkeypatch):
    monkeypatch.setattr(grids, "WORTH_COMPILING", worth)
    law, xi = together(drawn(3, density, 40)), np.linspace(0, 1, 61)
    for force in SPACE.forces:
        points = law.at(force, np.tile(xi, (40, 1)))
        np.testing.assert_allclose(
            law.on_grid(force, xi), points, rtol=0, atol=1e-13 * np.abs(points).max()
        )


@pytest.mark.parametrize("density", DENSITIES)
def test_bending_moments_go_by_the_shear_forces(density):
    """d(bending_z)/d(xi) = -shear_y and d(bending_y)/d(xi) = shear_z, by differences that share
    nothing with the law.
    """
    links, e = drawn(11, density, 12, stations=1), 1e-4
    for link in links:
        link.stations = [(0.55, *link.stations[0][1:])]
    places = np.array([0.1, 0.35, 0.5, 0.7, 0.93])
    xi = np.tile(places, (12, 1))
    law = together(links)
    for bending, shear, sign in (("bending_z", "shear_y", -1.0), ("bending_y", "shear_z", 1.0)):
        near = [
            np.array([[link.at(u + k * e)[bending] for u in places] for link in links])
            for k in (-2, -1, 1, 2)
        ]
        difference = (near[0] - 8 * near[1] + 8 * near[2] - near[3]) / (12 * e * LENGTH)
        np.testing.assert_allclose(difference, sign * law.at(shear, xi), rtol=1e-8, atol=1e-7)
        np.testing.assert_allclose(
            law.along(bending, xi), sign * LENGTH * law.at(shear, xi), rtol=1e-14
        )
    for force in SPACE.forces:
        near = [law.at(force, xi + k * e) for k in (-2, -1, 1, 2)]
        difference = (near[0] - 8 * near[1] + 8 * near[2] - near[3]) / (12 * e)
        np.testing.assert_allclose(law.along(force, xi), difference, rtol=1e-7, atol=1e-6)


@settings(max_examples=30, deadline=None)
@given(SEEDS, KINDS, st.integers(0, 3), st.sampled_from([0.0, 3.0, 40.0]))
def test_extremes_are_those_of_a_dense_search(seed, density, stations, spin):
    """Nothing on a fine grid, of either side of every station, is beyond the extremes, and they are
    values of the law.
    """
    law = together(drawn(seed, density, 6, stations, spin))
    fine = np.linspace(0, 1, 4001)
    for force in SPACE.forces:
        place, value = law.extreme(force)
        grid = law.on_grid(force, fine)
        beside = [
            law.at(force, load.station[:, None], side)
            for load in law.loads
            for side in ("tip", "base")
        ]
        values = np.hstack([grid, *beside])
        size, spread = np.abs(values).max(axis=1), np.ptp(values, axis=1)
        assert (np.abs(value) >= size * (1 - 1e-12)).all()
        assert (np.abs(value) <= size + 1e-5 * spread + 1e-300).all()
        here = [law.at(force, place[:, None], side)[:, 0] for side in ("tip", "base")]
        assert np.min([np.abs(values - value) for values in here], axis=0) == pytest.approx(
            0.0, abs=1e-12 * size.max()
        )
        places, ends = law.reached(force)
        assert (ends[0] <= values.min(axis=1) + 1e-12 * size).all()
        assert (ends[1] >= values.max(axis=1) - 1e-12 * size).all()
        assert ((places >= 0.0) & (places <= 1.0)).all()


def test_a_resultant_may_have_two_summits_between_its_ends():
    """M runs through an S beside the origin: M .

    M' = 0 five times, and both summits are among the curves.
    """
    # With v = 1 - u, m = l = 1: M_z = mz0 + fy0 v + (fy1 v^2 / 2 + ...): a cubic in each plane,
    # chosen by its values.
    v = np.linspace(0, 1, 4)
    wanted = {"bending_z": [0.0, 1.0, -1.0, 0.0], "bending_y": [0.3, -0.25, 0.25, -0.3]}
    density = NumericDensity((0.0, 1.0), ((1.0,),))
    coefficients = {name: np.zeros(1) for name in SPACE.law}
    for bending, values in wanted.items():
        terms = SPACE.sections[bending].coefficients
        rows = []
        for name in terms:
            unit = {other: np.ones(1) if other == name else np.zeros(1) for other in SPACE.law}
            rows.append(SectionLaw(1.0, density, unit).at(bending, 1 - v[None])[0])
        for name, x in zip(terms, np.linalg.solve(np.transpose(rows), values), strict=True):
            coefficients[name] = np.array([x])
    law = SectionLaw(1.0, density, coefficients)
    fine = np.linspace(0, 1, 100_001)
    sizes = law.on_grid("bending", fine)[0]
    tops = 1 + np.flatnonzero((sizes[1:-1] > sizes[:-2]) & (sizes[1:-1] > sizes[2:]))
    assert tops.size == 2
    places, values = law.curves("bending")
    for top in tops:
        k = np.argmin(np.abs(places[0] - fine[top]))
        assert places[0, k] == pytest.approx(fine[top], abs=2e-5)
        assert sizes[top] <= values[0, k] <= sizes[top] * (1 + 1e-9)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("force", ["shear", "bending"])
@pytest.mark.parametrize("density", ["even", "in cells"])
def test_where_a_resultant_turns_goes_on_from_instant_to_instant(force, density):
    """A slow link, whose pattern of zeros changes all the time: their summits do not jump, but
    where one comes or goes.
    """
    n = 20_001
    s = np.linspace(0, 2 * np.pi, n)
    law = together(drawn(8, density, 1, stations=1, spin=1e-2))
    wave = {name: np.cos(s + k) * law.coefficients[name] for k, name in enumerate(SPACE.law)}
    (load,) = law.loads
    acting = {
        name: np.cos(2 * s + k) * getattr(load, name) for k, name in enumerate(SPACE.place_first)
    }
    loads = (SpatialPointLoad("", **acting | {"station": np.full(n, 0.45)}),)
    places, values = SectionLaw(LENGTH, law.density, wave, loads).curves(force)
    assert places.shape == (n, 8)
    largest, size = np.abs(values).max(axis=1), np.abs(values).max()
    assert np.abs(np.diff(largest)).max() <= 2e-3 * size
    jumps = np.abs(np.diff(values, axis=0)) > 1e-2 * size
    assert jumps.sum(axis=0).max() <= 6
    assert np.ptp(places, axis=0).max() > 0.05


@pytest.mark.parametrize("end", [0.0, 1.0])
@pytest.mark.parametrize("across", [0.0, 0.7])
@pytest.mark.parametrize("second", [3.0, -3.0, 1e-30])
@pytest.mark.parametrize("stations", [0, 1])
@pytest.mark.parametrize("density", ["even", "in cells"])
def test_what_turns_at_an_end_but_for_rounding_stays_there(second, stations, density, across, end):
    """A link whose base or tip is at rest, without weight: its shear forces turn there, and so does
    their resultant.

    Each curve that is more than an end's goes on: none jumps from what is an end's to what is not.
    """
    noise = 1e-15 * np.random.default_rng(1).normal(size=(2, 400))
    coefficients = {name: np.zeros(400) for name in SPACE.law}
    for axis, share, less in zip("yz", (1.0, across), noise, strict=True):
        of = share * second
        law = {"0": np.full(400, -0.2 * of), "1": (less - LENGTH * end) * of, "2": np.full(400, of)}
        coefficients |= {f"f{axis}{k}": values for k, values in law.items()}
    (link,) = drawn(5, density, 1, stations=0)
    nothing = {name: np.zeros(400) for name in SPACE.place_first}
    loads = tuple(
        SpatialPointLoad(f"load{k}", **nothing | {"station": np.full(400, 0.7)})
        for k in range(stations)
    )
    law = SectionLaw(LENGTH, link.density, coefficients, loads)
    for force in SPACE.forces:
        _, values = law.curves(force)
        ends, size = 2 + 2 * stations, np.abs(values).max()
        for curve in values.T[ends:]:
            own = np.abs(curve[:, None] - values[:, :ends]).min(axis=1) > 1e-9 * size
            assert own.all() or not own.any(), force
            assert not own.any() or np.ptp(curve) <= 1e-12 * size, force


@pytest.mark.parametrize("side", ["tip", "base"])
@pytest.mark.parametrize("force", SPACE.forces)
def test_rates_are_those_of_differences(force, side):
    """At ratios that stand still, and at the station, which takes them along."""
    random = np.random.default_rng(2)
    curves = [np.polynomial.Polynomial(random.normal(size=3) * [3.0, 2.0, 1.0]) for _ in range(18)]
    station = np.polynomial.Polynomial([0.35, 0.2, -0.04])

    def moving(t, order=0):
        def at(curve):
            return np.array([curve.deriv(order)(t) if order else curve(t)])

        load = SpatialPointLoad("pin", at(station), *(at(curve) for curve in curves[12:]))
        coefficients = {name: at(curve) for name, curve in zip(SPACE.law, curves[:12], strict=True)}
        return SectionLaw(LENGTH, DENSITIES["in cells"], coefficients, (load,))

    def forces(t):
        return moving(t).at(force, np.array([[0.1, 0.37, float(station(t)), 0.9]]), side)

    t, e = 0.3, 1e-4
    near = [forces(t + k * e) for k in (-2, -1, 1, 2)]
    difference = (near[0] - 8 * near[1] + 8 * near[2] - near[3]) / (12 * e)
    rate = moving(t).rate(
        force, moving(t, 1), np.array([[0.1, 0.37, float(station(t)), 0.9]]), side
    )
    np.testing.assert_allclose(rate, difference, rtol=1e-8, atol=1e-8)
    assert np.max(np.abs(rate)) > 1e-3


@given(SEEDS, st.floats(1e-9, 1e-3))
def test_changes_are_those_of_a_changed_law(seed, little):
    """Of resultants too, and where these are nearly zero."""
    law, other = (together(drawn(seed + k, "tapered", 3, stations=1)) for k in range(2))
    gaps = {name: little * values[None] for name, values in other.coefficients.items()}
    shifts = [
        SpatialPointLoad(
            "",
            *(
                np.zeros((1, 3)) if m == "station" else little * getattr(load, m)[None]
                for m in SPACE.place_first
            ),
        )
        for load in other.loads
    ]
    changed = law.changed(
        SectionLaw(LENGTH, law.density, gaps, tuple(shifts)), np.array([0.0, 0.3, 1.0])
    )
    after = SectionLaw(
        LENGTH,
        law.density,
        {name: values + gaps[name][0] for name, values in law.coefficients.items()},
        tuple(
            SpatialPointLoad(
                "", *(getattr(load, m) + getattr(shift, m)[0] for m in SPACE.place_first)
            )
            for load, shift in zip(law.loads, shifts, strict=True)
        ),
    )
    u = np.stack([*(np.full(3, x) for x in (0.0, 0.3, 1.0)), law.loads[0].station], axis=-1)
    for force in SPACE.forces:
        found, sizes = changed[force]
        for k, side in enumerate(("tip", "base")):
            expected = after.at(force, u, side) - law.at(force, u, side)
            np.testing.assert_allclose(
                found[0, ..., k], expected, rtol=0, atol=1e-12 * np.max(sizes)
            )
        assert (sizes[..., 0] >= np.abs(law.at(force, u)) * (1 - 1e-12)).all()
        assert law.bound(force, np.array([0.0, 0.3, 1.0])) >= np.max(
            np.abs(law.at(force, u[:, :3]))
        ) * (1 - 1e-12)


def test_what_a_resultant_is_made_of():
    outputs = [Output("law", "rod", member) for member in SPACE.law]
    outputs += [Output("station", "rod", member, "A") for member in SPACE.load_point]
    found = made_of(outputs, "rod", "bending", SPACE)
    assert {output.member for output in found if not output.load_point} == {
        "my0",
        "mz0",
        "fy0",
        "fy1",
        "fy2",
        "fz0",
        "fz1",
        "fz2",
    }
    assert {output.member for output in found if output.load_point} == {"my", "mz", "fy", "fz"}
    assert [str(output) for output in made_of(outputs, "rod", "torsion", SPACE)] == [
        "section:rod:law:mx0",
        "section:rod:A:mx",
    ]


def test_a_section_shows_the_forces_of_its_mechanism():
    law, xi = together(drawn(1, "even", 4)), np.linspace(0, 1, 5)
    section = Section(law, xi)
    for force in SPACE.forces:
        np.testing.assert_array_equal(section.array(force), getattr(section, force))
        assert section.array(force).tobytes() == law.on_grid(force, xi).tobytes()
    planar = SectionLaw(
        1.0, law.density, {name: np.zeros(1) for name in ("n0", "n1", "n2", "f0", "f1", "f2", "m0")}
    )
    with pytest.raises(UnknownNameError, match=r"section force.*'torsion'.*axial, shear, bending"):
        Section(planar, xi).torsion.sum()
