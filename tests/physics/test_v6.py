"""The V6 against the closed form of its slider-cranks: power and momentum; and its file."""

import math

import h5py
import numpy as np
import pytest
from conftest import CASES

from lagrange_casadi import evaluate, load_case, save

G = 9.81
THROWS = {"1": 0.0, "2": 2 * math.pi / 3, "3": 4 * math.pi / 3}
R, L, ROD, PISTON = 0.04, 0.14, 0.55, 0.4
WANTED = ["effort", "motion", "reaction", "load"]


@pytest.fixture(scope="module")
def module():
    return load_case(CASES / "v6")


def pistons(theta, bank):
    """Of each cylinder its direction, and the places of crank pin and piston on the plane y, z."""
    for bank_name, side in (("left", 1), ("right", -1)):
        for number, throw in THROWS.items():
            u = np.array([math.cos(side * bank / 2), math.sin(side * bank / 2)])
            pin = R * np.array([np.cos(theta + throw), np.sin(theta + throw)])
            along, across = u @ pin, u[0] * pin[1] - u[1] * pin[0]
            yield f"{bank_name}_{number}", u, pin, u[:, None] * (along + np.sqrt(L**2 - across**2))


def matter(theta, bank):
    """Masses of rods and pistons as points (a rod is three: Simpson's rule), and places (2, n)."""
    for _, _, pin, piston in pistons(theta, bank):
        yield from ((ROD / 6, pin), (ROD * 2 / 3, (pin + piston) / 2))
        yield PISTON + ROD / 6, piston


def slope(values):
    """The derivative by the angle of what is periodic over the two turns, by Fourier series."""
    n = values.shape[-1]
    wave = 1j * np.fft.fftfreq(n, 1.0 / n) / 2.0
    return np.fft.ifft(np.fft.fft(values) * wave).real


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"bank": math.pi / 2, "load": 0.0},
        {"bank": math.pi / 3, "rpm": 5000.0, "right_3_turn": 0.0, "left_1_turn": 1.0},
    ],
)
def test_power_and_momentum(module, values):
    found = evaluate(module.scene, parameters=values, wanted=WANTED)
    assert found.certified
    assert not [name for name in found.undetermined if name.startswith("effort")]
    theta, bank = found.motion("main_fixed:turn_1").value[:-1], values.get("bank", 2 * math.pi / 3)
    w = values.get("rpm", 3000.0) * math.pi / 30
    kinetic, potential, momentum = 0.0, 0.0, np.zeros((2, theta.size))
    for mass, place in matter(theta, bank):
        speed = w * slope(place)
        kinetic = kinetic + mass * np.sum(speed**2, axis=0) / 2
        potential = potential + mass * G * place[1]
        momentum += mass * speed
    # The bent bar: 12 kg/m on three throws, whose centres are at half of the radius in the cheeks.
    for throw in THROWS.values():
        reach = 12.0 * (0.06 * R + 2 * R * R / 2)
        turned = theta + throw
        potential = potential + reach * G * np.sin(turned)
        momentum += reach * w * np.array([-np.sin(turned), np.cos(turned)])
    gas, pushed = 0.0, np.zeros((2, theta.size))
    for name, u, _, piston in pistons(theta, bank):
        push = np.array([found.array(f"load:{name}_gas:f{axis}")[:-1] for axis in "yz"])
        gas = gas + np.sum(push * slope(piston), axis=0)
        pushed += push
        assert np.abs(u[0] * push[1] - u[1] * push[0]).max() < 1e-9
        # It burns near its upper dead centre, once in two turns.
        if values.get("load", 1.0):
            k = int(np.argmax(np.hypot(*push)))
            reach = (u @ piston)[k] / (R + L)
            assert reach > 0.985
    told = slope(kinetic + potential) - gas
    effort = found.effort("main_fixed:turn_1")[:-1]
    assert np.abs(effort - told).max() < 1e-10 * np.abs(told).max()
    whole = 6 * (ROD + PISTON) + 12.0 * (4 * 0.05 + 3 * 0.06 + 6 * R) + 8.0
    told = w * slope(momentum) - pushed - np.array([[0.0], [-whole * G]])
    walls = [f"{name}_wall" for name, *_ in pistons(theta, bank)]
    every = [
        np.array([found.array(f"reaction:{name}:f{axis}")[:-1] for axis in "yz"])
        for name in ("main_fixed", "main_floating", *walls)
    ]
    assert np.abs(sum(every) - told).max() < 1e-10 * np.abs(every).max()


def test_its_file_is_small(module, tmp_path):
    """The pieces of the crankshaft have their laws alone."""
    found = evaluate(module.scene, certificate=False)
    for name, grids in (("usual", None), ("laws", False)):
        save(found, tmp_path / name, grids=grids)
    with h5py.File(tmp_path / "usual") as file:
        links = {link for link in file["section"] if "bending" in file["section"][link]}
        assert links == {f"{side}_{k}_rod" for side in ("left", "right") for k in THROWS}
        assert len(file["section"]) == 19
    assert (tmp_path / "usual").stat().st_size < 9e6
    assert (tmp_path / "laws").stat().st_size < 6e6
