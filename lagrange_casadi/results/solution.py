"""Result of an evaluation: histories of outputs, and the evidence that they are right."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal, cast

import numpy as np

from ..base.arguments import public
from ..base.arrays import Array
from ..base.methods import method
from ..engine.instants.beyond_equilibrium import Elasticity, Holding, held_notes
from ..model.notes import notes
from .data_frames import dataset, frame
from .derivatives import Derivatives
from .drive_use import DriveUse, drives_used
from .histories import Histories

if TYPE_CHECKING:
    import pandas
    import xarray

    from .elastic.deflection import Deflection
    from .pictures import Animation, Film, View
    from .strength.safety import Life, Safety
    from .strength.stress import Stress


@public
@dataclass(frozen=True, eq=False, repr=False)
class Solution(Histories):
    """The outputs of a scene over its instants, and what is known of them: see :class:`.Histories`.

    ``certificate`` holds the residuals of :mod:`.certificate`, each (t,), and how near the loops
    are to a dead centre; a residual above ``tolerance`` means that the solution is wrong, not that
    it is rounded. ``errors`` estimates by :mod:`.accuracy` how far each quantity may be off, over
    all instants, in its unit. ``elasticity`` says which outputs least strain energy determined;
    ``sensitivities`` are derivatives by parameters, where these were wanted; ``holding`` are ranges
    of efforts that hold joints at rest.
    """

    certificate: Mapping[str, Array] = field(default_factory=dict)
    errors: Mapping[str, float] = field(default_factory=dict)
    tolerance: float = 0.0
    elasticity: Elasticity = field(default_factory=Elasticity)
    sensitivities: Derivatives = field(default_factory=Derivatives)
    holding: Mapping[str, Holding] = field(default_factory=dict)

    _over_time = (*Histories._over_time, "certificate", "sensitivities", "holding")

    @property
    def failed(self) -> dict[str, float]:
        """The residuals that are above the tolerance, or no numbers, and the largest of each."""
        residuals = {
            name: float(np.max(v, initial=0.0))
            for name, v in self.certificate.items()
            if name != "condition"
        }
        return {name: value for name, value in residuals.items() if not value <= self.tolerance}

    @property
    def certified(self) -> bool:
        """True if there are residuals, and none of them fails."""
        return any(name != "condition" for name in self.certificate) and not self.failed

    def __repr__(self) -> str:
        many = sum(1 for _ in self.names())
        word = (
            "certified"
            if self.certified
            else "its certificate fails"
            if self.failed
            else "no certificate"
        )
        return (
            f"<Solution of {self.case}: {self.t.size} instants, {self.xi.size} ratios, {many}"
            f" quantities, {word}>"
        )

    def stress(self, link: str) -> Stress:
        """Return the stresses [Pa] in a link that has a beam: see :func:`.strength.stress`."""
        return cast("Stress", method("Solution.stress")(self, link))

    def safety(
        self, link: str, *, criterion: str = "goodman", yield_criterion: str = "von_mises"
    ) -> Safety:
        """Return the factors of safety of a link that has a beam, or of what is fitted to a joint:
        see :func:`.strength.safety`.
        """
        return cast(
            "Safety",
            method("Solution.safety")(
                self, link, criterion=criterion, yield_criterion=yield_criterion
            ),
        )

    def life(self, link: str, *, criterion: str = "goodman") -> Life:
        """Return the fatigue life of a link that has a beam: see :func:`.strength.life`."""
        return cast("Life", method("Solution.life")(self, link, criterion=criterion))

    def deflection(self, link: str, against: Literal["ends", "base"] | None = None) -> Deflection:
        """Return the deflection of a link: see :func:`.elastic.deflection.deflection`."""
        return cast("Deflection", method("Solution.deflection")(self, link, against))

    def drives_used(self) -> dict[str, DriveUse]:
        """Return how much of its largest effort and speed each drive uses that has limits, by the
        names of drives: ``drives_used()["motor"].effort.share``.
        """
        return drives_used(self)

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks on a valid result: points beyond the end of a link, joints with friction at rest,
        links that vibrate.
        """
        known = {
            output: values
            for output, values in self.outputs.items()
            if output not in self.indeterminate
        }
        found = notes(self.t, known, self.description, self.resting)
        slopes = (
            () if self.resting.any() else self.sensitivities.notes()
        )  # at rest all that rubs is open
        if any(output.group == "deflection" for output in self.outputs):
            slopes = (*slopes, *method("Solution.notes")(self))
        return (*found, *held_notes(self.holding), *self.elasticity.notes, *slopes)

    @property
    def by_equilibrium(self) -> Solution:
        """Solution without the results from elasticity: these are indeterminate, and NaN."""
        completed = self.elasticity.completed
        nothing = {output: np.full_like(self.t, np.nan) for output in completed}
        return replace(
            self,
            outputs={**self.outputs, **nothing},
            indeterminate=(*self.indeterminate, *completed),
            elasticity=Elasticity(),
        )

    def report(self, path: str | os.PathLike[str], beside: Solution | None = None) -> None:
        """Write a page for browsers: the mechanism in motion, its forces, charts and tables.

        Parameters
        ----------
        path : path
            The file, which ends in .html.
        beside : Solution, optional
            Another solution; the page shows both side by side, and how they differ.

        Raises
        ------
        DeclarationError
            If motion was not evaluated, or the path ends otherwise.
        PathError, StoreError
            If the file cannot be written.
        """
        if beside is None:
            method("Solution.report")(self, path)
        else:
            method("Solution.report_beside")((self, beside), path)

    def animate(self, path: str | os.PathLike[str], film: Film | None = None) -> Animation:
        """Write one cycle in motion, as a GIF, an MP4, an animated SVG or glTF, as the path ends:
        see :func:`.write_animation`.
        """
        return cast("Animation", method("Solution.animate")(self, path, film))

    def view(self, height: int = 760) -> View:
        """Return the report's page for a notebook, which shows it in a frame.

        Parameters
        ----------
        height : int
            Height of the frame [points].

        Returns
        -------
        View
            The page, for the last line of a cell.

        Raises
        ------
        DeclarationError
            If motion was not evaluated.
        """
        return cast("View", method("Solution.view")(self, height))

    def _repr_html_(self) -> str:
        """Show a drawing and the peaks in a notebook."""
        return cast("str", method("Solution._repr_html_")(self))

    def to_xarray(self) -> xarray.Dataset:
        """Return all quantities as an ``xarray.Dataset`` over t and xi, with units.

        Returns
        -------
        xarray.Dataset
            The quantities by full name.

        Raises
        ------
        LagrangeCasadiError
            If xarray is not installed.
        """
        return dataset(self, self.sensitivities)

    def to_pandas(self) -> pandas.DataFrame:
        """Return all quantities as a ``pandas.DataFrame``, with units in the heads.

        Returns
        -------
        pandas.DataFrame
            A row per instant; a section force has a column for each xi.

        Raises
        ------
        LagrangeCasadiError
            If pandas is not installed.
        """
        return frame(self, self.sensitivities)
