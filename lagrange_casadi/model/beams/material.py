"""Materials by their numbers, and a small table of some with its sources, which was not compared
with the printed standards.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

from ...base.arguments import Positive, Stress, public
from ...base.brief import Brief
from ...base.units import Within
from ...errors import DeclarationError, check_known

MassDensity: TypeAlias = Annotated[Any, Within(0.0, above=True, unit="kg/m^3")]
Cycles: TypeAlias = Annotated[float, Within(1e3, above=True)]


@public
@dataclass(frozen=True, repr=False)
class Material(Brief):
    """A material, in SI units; what is not known is None, and whatever needs it says so.

    ``density`` [kg/m^3]; ``elasticity``, ``shear_modulus``, by default by Poisson's ratio of 0.3,
    and ``yield_strength``, ``ultimate`` [Pa]. ``endurance`` is the amplitude of stress [Pa] that
    the part bears ``endurance_cycles`` times, and for ever where ``endless``: that of the part,
    after what its surface, size and loading take off. Amplitudes between a thousand cycles and
    these are on a line of the logarithms from ``fatigue_share`` times the ultimate strength
    (Shigley, *Mechanical Engineering Design*, 9th edition, section 6-8). ``fatigue_strength`` is
    the coefficient of Morrow's mean stress, by default the ultimate strength and 345 MPa (Dowling,
    *Mechanical Behavior of Materials*, for steels).

    Raises :class:`.DeclarationError` for numbers that are not positive, or do not go together.
    """

    name: str
    density: MassDensity
    elasticity: Stress | None = None
    shear_modulus: Stress | None = None
    yield_strength: Stress | None = None
    ultimate: Stress | None = None
    endurance: Stress | None = None
    endurance_cycles: Cycles = 1e6
    endless: bool = True
    fatigue_share: Positive = 0.9
    fatigue_strength: Stress | None = None

    def __post_init__(self) -> None:
        for low, high in (("yield_strength", "ultimate"), ("endurance", "ultimate")):
            a, b = getattr(self, low), getattr(self, high)
            if a is not None and b is not None and a > b:
                raise DeclarationError(
                    f"material '{self.name}': {low} {a:g} Pa is above {high} {b:g} Pa"
                )
        if (
            self.endurance is not None
            and self.ultimate is not None
            and self.endurance >= self.fatigue_share * self.ultimate
        ):
            share = (
                f"{self.fatigue_share:g} of the ultimate strength,"
                f" {self.fatigue_share * self.ultimate:g} Pa"
            )
            raise DeclarationError(
                f"material '{self.name}': endurance {self.endurance:g} Pa must be below {share}"
            )
        if self.shear_modulus is None and self.elasticity is not None:
            object.__setattr__(self, "shear_modulus", self.elasticity / 2.6)

    def needs(self, what: str, *names: str) -> tuple[float, ...]:
        """Return numbers of the material, none of which may be missing.

        Parameters
        ----------
        what : str
            Subject of the message.
        *names : str
            Names of the numbers, as ``"elasticity"``.

        Returns
        -------
        tuple of float
            The numbers in this order, in SI units.

        Raises
        ------
        DeclarationError
            If some are missing; the message names them.
        """
        missing = [name for name in names if getattr(self, name) is None]
        if missing:
            raise DeclarationError(
                f"material '{self.name}' has no {' and no '.join(missing)}, which {what} needs"
            )
        return tuple(getattr(self, name) for name in names)

    def but(self, **numbers: Any) -> Material:
        """Return the material with other numbers.

        An endurance limit that is a share of the ultimate strength is not changed with it.

        Parameters
        ----------
        **numbers : float
            Numbers by name, in SI units.

        Returns
        -------
        Material
            The other material.

        Raises
        ------
        DeclarationError
            If they do not fit each other.
        """
        found = vars(self) | numbers
        return Material(found.pop("name"), **found)


@public
def material(name: str) -> Material:
    """Return a material of a small table, with the least values of standards for thin parts.

    Parameters
    ----------
    name
        Name such as ``"S355"`` or ``"C45+QT"``.

    Returns
    -------
    Material
        The material; :meth:`.Material.but` changes some of its numbers.

    Raises
    ------
    UnknownNameError
        For any other name; the message lists all.
    """
    check_known("material", [name], TABLE)
    return TABLE[name]


_STEEL: dict[str, Any] = {"density": 7850.0, "elasticity": 210e9, "shear_modulus": 81e9}


def _steel(name: str, strength: float, ultimate: float) -> Material:
    return Material(
        name, **_STEEL, yield_strength=strength, ultimate=ultimate, endurance=ultimate / 2
    )


TABLE = {
    found.name: found
    for found in (
        _steel("S235", 235e6, 360e6),
        _steel("S355", 355e6, 470e6),
        _steel("C45+QT", 490e6, 700e6),
        _steel("42CrMo4+QT", 900e6, 1100e6),
        Material("EN-GJS-400-15", 7100.0, 169e9, 66e9, 250e6, 400e6),
        Material("EN AW-6082-T6", 2700.0, 70e9, 26.3e9, 250e6, 295e6),
        Material("Ti-6Al-4V", 4430.0, 114e9, 44e9, 828e6, 895e6),
    )
}
"""Strengths: EN 10025-2 (S235, S355, up to 16 mm), EN ISO 683-1 and -2 (C45+QT, 42CrMo4+QT, up to
16 mm), EN 1563, EN 755-2 (extruded rod of at most 20 mm), ASTM B348 grade 5. Moduli of steel: EN
1993-1-1, 3.2.6. The endurance limit of steels is half the ultimate strength, that of a polished
rotating beam (Shigley, eq. 6-8): a part's own is lower. The others have none."""
