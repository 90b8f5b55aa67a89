"""Shipped tables: masses that standards publish, ratings by Hertz and by tables of ISO, and users'
own tables.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from lagrange_casadi import actuators, beams, bearings
from lagrange_casadi.errors import DeclarationError, PathError

pytestmark = pytest.mark.usefixtures("interpreted")

# Radius of the fillets [mm] and mass per length [kg/m] of EN 10365.
PUBLISHED = {
    "IPE": """80 5 6.0, 100 7 8.1, 120 7 10.4, 140 7 12.9, 160 9 15.8, 180 9 18.8, 200 12 22.4,
        220 12 26.2, 240 15 30.7, 270 15 36.1, 300 15 42.2, 330 18 49.1, 360 18 57.1, 400 21 66.3,
        450 21 77.6, 500 21 90.7, 550 24 106, 600 24 122""",
    "HEA": """100 12 16.7, 120 12 19.9, 140 12 24.7, 160 15 30.4, 180 15 35.5, 200 18 42.3,
        220 18 50.5, 240 21 60.3, 260 24 68.2, 280 24 76.4, 300 27 88.3, 320 27 97.6, 340 27 105,
        360 27 112, 400 27 125, 450 27 140, 500 27 155, 550 27 166, 600 27 178""",
    "HEB": """100 12 20.4, 120 12 26.7, 140 12 33.7, 160 15 42.6, 180 15 51.2, 200 18 61.3,
        220 18 71.5, 240 21 83.2, 260 24 93.0, 280 24 103, 300 27 117, 320 27 127, 340 27 134,
        360 27 142, 400 27 155, 450 27 171, 500 27 187, 550 27 199, 600 27 212""",
}


@pytest.mark.parametrize("series", PUBLISHED)
def test_sections_have_the_mass_that_the_standard_publishes(series):
    """With the fillets at the web, (4 - pi) r^2: to the last digit of each row."""
    found = beams.read_profiles(series)
    rows = [row.split() for row in PUBLISHED[series].split(",")]
    assert [profile.name for profile in found] == [f"{series} {size}" for size, *_ in rows]
    for profile, (_, radius, mass) in zip(found, rows, strict=True):
        area = float(profile.shape("i_section").area)
        whole = area + (4 - math.pi) * (float(radius) / 1e3) ** 2
        last = 0.05 if "." in mass else 0.5
        assert abs(7850 * whole - float(mass)) <= 1.05 * last, profile.name
        assert area > 0.92 * whole


# Area [cm^2], second moment [cm^4] and modulus [cm^3] about the axis of the greater one, then about
# the other, torsion constant [cm^4] and modulus [cm^3]: EN 10210-2 and EN 10219-2.
HOLLOW = {
    "SHS 50x50x5": "8.73 28.9 11.6 28.9 11.6 47.6 16.7",
    "SHS 100x100x5": "18.7 279 55.9 279 55.9 439 81.8",
    "SHS 100x100x10": "34.9 462 92.4 462 92.4 761 133",
    "SHS 200x200x10": "74.9 4471 447 4471 447 7031 655",
    "RHS 100x50x5": "13.7 167 33.3 54.3 21.7 135 36.9",
    "SHS cold 50x50x3": "5.41 19.5 7.79 19.5 7.79 32.1 11.8",
    "SHS cold 100x100x4": "14.9 226 45.3 226 45.3 362 68.1",
    "RHS cold 200x100x8": "43.2 2091 209 705 141 1811 250",
}


@pytest.mark.parametrize("name", HOLLOW)
def test_hollow_sections_have_the_properties_that_the_standards_publish(name):
    """To the last digit of each row."""
    rows = beams.read_profiles(name.rpartition(" ")[0].replace(" ", "_"))
    (profile,) = (row for row in rows if row.name == name)
    found = profile.shape("hollow_section").properties()
    twist = max(abs(fibre.along_z[2]) for fibre in found.fibres)
    numbers = (1e4 * found.area, 1e8 * found.iz, 1e6 * found.wz, 1e8 * found.iy, 1e6 * found.wy)
    for value, text in zip(
        (*numbers, 1e8 * found.torsion, 1e6 / twist), HOLLOW[name].split(), strict=True
    ):
        last = 10.0 ** -len(text.partition(".")[2])
        assert abs(value - float(text)) <= 0.51 * last, (value, text)


def test_every_table_says_where_it_is_from_and_fits_a_shape():
    hollow = dict.fromkeys(("SHS", "RHS", "SHS_cold", "RHS_cold"), "hollow_section")
    kinds = {"CHS": "tube", "flat": "rectangle", "round": "round_bar"} | hollow
    tables = {
        path.stem: path
        for path in (Path(beams.__file__).parent / "model" / "beams" / "tables").iterdir()
    }
    assert set(tables) == {*PUBLISHED, *kinds}
    for name, path in tables.items():
        head = path.read_text().partition("\nname,")[0].replace("\n# ", " ")
        words = (" EN 10", " computed ", "not compared with the printed standard")
        assert all(word in head for word in words), head
        for profile in beams.read_profiles(name):
            demands = profile.shape(kinds.get(name, "i_section")).parameter_constraints()
            assert all(float(demand) > 0 for demand, _ in demands), profile.name


def test_a_file_of_the_same_name_comes_first(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "IPE").write_text("name,diameter\nmine,0.1\n")
    assert [profile.name for profile in beams.read_profiles("IPE")] == ["mine"]
    (tmp_path / "servo").write_text(
        "name,stall_torque,rated_torque,rated_speed,peak_torque,max_speed,inertia\n"
        "mine,1,1,3000,3,5000,1e-5\n"
    )
    assert [motor.name for motor in actuators.read_motors("servo")] == ["mine"]


def test_a_name_of_no_table_lists_those_there_are(here):
    tables = "tables: CHS, HEA, HEB, IPE, RHS, RHS_cold, SHS, SHS_cold, flat, round"
    for read, listed in (
        (beams.read_profiles, tables),
        (actuators.read_motors, "classes: servo, induction"),
    ):
        with pytest.raises(PathError, match=f"^IPX: no such file; {listed}$"):
            read("IPX")
        with pytest.raises(PathError, match=r"^IPX\.csv: no such file$"):
            read("IPX.csv")


@pytest.mark.parametrize("name", ["servo", "induction"])
def test_motors_of_a_class_follow_its_rule(name):
    """The shear stress on the rotor makes the torque at rest, and its mass turns."""
    shear, slender = {"servo": (15e3, 1.5), "induction": (10e3, 1.2)}[name]
    motors = actuators.read_motors(name)
    for motor in motors:
        radius = (2 * motor.inertia / (7850 * math.pi * 2 * slender)) ** 0.2
        mass = 7850 * math.pi * radius**2 * (2 * radius * slender)
        assert motor.inertia == pytest.approx(mass * radius**2 / 2, rel=1e-12)
        surface = 2 * math.pi * radius * (2 * radius * slender)
        assert motor.stall_torque == pytest.approx(shear * surface * radius, rel=1e-12)
        assert motor.rated_torque <= motor.stall_torque < motor.peak_torque
        assert motor.name == f"class {name} {motor.rated_power / 1e3:.6g} kW"
    assert sorted(motors, key=lambda motor: motor.rated_power) == motors


# f_c of ISO 281 over the ratio of ball and pitch diameters (Shigley, Harris and ISO print it).
F_C = {0.05: 46.7, 0.1: 55.5, 0.12: 57.5, 0.14: 58.8, 0.16: 59.6, 0.2: 59.9, 0.24: 59.0, 0.3: 56.0}


F_C |= {0.36: 51.7, 0.4: 48.4}


@pytest.mark.parametrize("share", F_C)
def test_the_dynamic_rating_has_the_factors_that_iso_prints(share):
    found = bearings.dynamic_rating(share * 0.06, 0.06, 8)
    size = share * 60
    assert found == pytest.approx(1.3 * F_C[share] * 4 * size**1.8, rel=1.5e-3)


def hertz(ball, pitch):
    """Load of a ball [N] at which the larger pressure in its grooves is 4200 MPa, by Hertz: the
    axes of the ellipse from the ratio of curvatures, with integrals by quadrature.
    """
    angle = (np.arange(4000) + 0.5) * math.pi / 8000
    module = 2.07e11 / (1 - 0.3**2)
    found = []
    for sign, groove in ((1, 0.52), (-1, 0.53)):
        race = (pitch - sign * ball) / 2
        rolling, across = 2 / ball + sign / race, 2 / ball - 1 / (groove * ball)
        total = rolling + across

        def integrals(k):
            root = np.sqrt(1 - (1 - 1 / k**2) * np.sin(angle) ** 2)
            return [float(np.mean(x)) * math.pi / 2 for x in (1 / root, root)]

        low, high = 1.0 + 1e-9, 60.0
        for _ in range(200):
            k = (low + high) / 2
            first, second = integrals(k)
            ratio = (k * k * second - first) / (first - second)
            low, high = (k, high) if ratio < rolling / across else (low, k)
        second = integrals(k)[1]
        # a^3 = 6 k^2 E Q / (pi total E*), E* of one steel on another; b = a/k, p = 3 Q/(2 pi a b).
        per = (6 * k * k * second / (math.pi * total * module)) ** (1 / 3)
        found.append((4.2e9 * 2 * math.pi * per**2 / k / 3) ** 3)
    return min(found)


@pytest.mark.parametrize("share", [0.05, 0.08, 0.12, 0.16, 0.2, 0.25, 0.3])
def test_the_static_rating_is_that_of_hertz(share):
    """A fifth of the load of all balls, at 4200 MPa."""
    ball, balls = 0.01, 9
    told = balls / 5 * hertz(ball, ball / share)
    assert bearings.static_rating(ball, ball / share, balls) == pytest.approx(told, rel=0.015)


def test_bearings_are_marked_as_computed_and_near_those_of_makers():
    """A bearing of 25 x 52 x 15 mm bears 14 kN, in any catalogue, and 7.8 kN at rest."""
    every = {bearing.name: bearing for bearing in bearings.deep_groove()}
    assert len(every) == 63
    assert all("no maker's rating" in bearing.source for bearing in every.values())
    found = every["6205"]
    assert (found.bore, found.outer, found.width) == (0.025, 0.052, 0.015)
    assert (found.dynamic, found.static) == pytest.approx((14e3, 7.8e3), rel=0.08)
    with pytest.raises(DeclarationError, match="expected one of 60, 62, 63"):
        bearings.deep_groove("61")


def test_a_table_of_ones_own_bearings(tmp_path):
    path = tmp_path / "bearings.csv"
    path.write_text(
        "# a maker's\nname;bore [mm];outer [mm];width [mm];dynamic [kN];static [kN]\n"
        "A;25;52;15;14,8;7,8\n"
    )
    (own,) = bearings.read_bearings(path)
    assert (own.name, own.bore, own.dynamic, own.static) == ("A", 0.025, 14.8e3, 7.8e3)
    assert own.source == str(path)
    assert own.rolling(100.0).dynamic == 14.8e3
    for text, told in (
        ("name,bore [mm]\n", r"expected one column 'outer' of name, bore"),
        (path.read_text().replace("14,8", "-1"), r"line 3: dynamic: expected a positive"),
    ):
        path.write_text(text)
        with pytest.raises(DeclarationError, match=told):
            bearings.read_bearings(path)
