"""Figures of a solution, declared as frozen specs, which a case may give and a file keeps.

Specs are known wherever cases are. How each is drawn is known in
:mod:`.figures.solution_figures`, imported when something is drawn.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, get_args

from ...base.arguments import Finite, public
from ...base.brief import Brief
from ...base.methods import method
from ...base.quantities import Output
from ...base.tables import PLANE
from ...base.units import Within
from ...base.vocabulary import AZIMUTH, ELEVATION
from ..solution import Solution
from .untrusted import parsed, structured

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _sections(*links: str) -> Iterable[str]:
    """Full names of all section forces of links."""
    return (str(Output("section", link, force)) for link in links for force in PLANE.forces)


_NEEDED: dict[str, Callable[..., Iterable[str]]] = {
    "quantity": lambda quantity: [quantity],
    "quantities": lambda quantities: quantities,
    "link": _sections,
    "links": lambda links: _sections(*links),
    "joints": lambda joints: (
        f"reaction:{one}:{force}" for one in joints for force in ("fx", "fy")
    ),
}
"""Full names of the quantities that a spec draws by one of its fields."""


class _Drawn:
    """A spec, which can be drawn."""

    def needs(self) -> tuple[str, ...]:
        """Full names of the quantities it draws; the poses of all bodies besides, if it draws
        these.
        """
        fields = [(_NEEDED[name], value) for name, value in vars(self).items() if name in _NEEDED]
        return tuple(one for named, value in fields for one in named(value))

    @public
    def draw(self, solution: Solution, si: bool = False) -> Figure:
        """The figure; axes have the units that people read, or with ``si`` those of SI, without
        prefixes.
        """
        found: Figure = method("Spec.draw")(self, solution, si)
        return found


@dataclass(frozen=True)
class _OfLink(_Drawn):
    """A spec of what is drawn of the section forces of one link."""

    name: str
    link: str


@public
@dataclass(frozen=True, repr=False)
class TimePlot(_Drawn, Brief):
    """Quantities over time, those of each unit on axes of their own; of a section force, one curve
    for each ratio in ``xi``.

    ``factor`` multiplies what is drawn: -1 turns the package's sign into another convention, which
    ``note`` then names.
    """

    kind: ClassVar[str] = "time"
    name: str
    quantities: tuple[str, ...]
    title: str = ""
    xi: tuple[float, ...] = ()
    factor: Finite = 1.0
    note: str = ""


@public
@dataclass(frozen=True, repr=False)
class SpanPlot(_Drawn, Brief):
    """A section force along its link at the instant nearest to ``t``."""

    kind: ClassVar[str] = "span"
    name: str
    quantity: str
    t: Annotated[Any, Within(unit="s")]
    title: str = ""
    factor: Finite = 1.0
    note: str = ""


@public
@dataclass(frozen=True)
class SectionMaps(_OfLink):
    """The section forces of a link as maps of time and xi/l, the peaks marked; a grid finer than
    the picture is thinned.

    In space there are six, and the resultants of shear and bending.
    """

    kind: ClassVar[str] = "maps"


@public
@dataclass(frozen=True)
class SectionDiagrams(_Drawn):
    """The section forces along links, each at the instant that governs it, as textbooks draw them:
    N, V and M, with values at ends and peaks.

    The instant is that of the largest stress where stresses were wanted, else of the largest
    bending moment.
    """

    kind: ClassVar[str] = "diagrams"
    name: str
    links: tuple[str, ...]


@public
@dataclass(frozen=True)
class PolarPlots(_Drawn):
    """The forces in joints over all instants, each as a polar plot: in the plane in ground axes, in
    space on axes across that of the joint.
    """

    kind: ClassVar[str] = "polar"
    name: str
    joints: tuple[str, ...]


@public
@dataclass(frozen=True)
class MechanismDrawing(_Drawn):
    """The mechanism at ``count`` instants, evenly spread over the motion until it repeats itself;
    positions that are the same once.

    With ``overlay`` they are in one picture, the first strong and the others faint. One in space is
    always drawn so: from above, from the front, from the right, and from ``azimuth`` and
    ``elevation`` [deg], the angle about the upward axis, and that above the level, of the direction
    from which it is looked at. The upward axis is the ground's axis that is most against gravity.
    """

    kind: ClassVar[str] = "drawing"
    name: str = "mechanism"
    count: int = 4
    azimuth: float = AZIMUTH
    elevation: float = ELEVATION
    overlay: bool = False


@public
@dataclass(frozen=True)
class StrengthPlot(_OfLink):
    """Von Mises' stress of a link that has a beam, over time and along it, and its swings in
    Goodman's diagram.
    """

    kind: ClassVar[str] = "strength"


@public
@dataclass(frozen=True)
class UtilisationPlot(_Drawn):
    """Utilisation of links that have a beam, and of joints that have pins or bearings, for each
    mode of failure.
    """

    kind: ClassVar[str] = "utilisation"
    name: str
    links: tuple[str, ...]
    joints: tuple[str, ...] = ()


@public
@dataclass(frozen=True)
class DeflectionPlot(_OfLink):
    """The deflection of a link that has a beam, over time and along it, and the harmonics of its
    bending.
    """

    kind: ClassVar[str] = "deflection"


Spec = (
    TimePlot
    | SpanPlot
    | SectionMaps
    | SectionDiagrams
    | PolarPlots
    | MechanismDrawing
    | StrengthPlot
    | UtilisationPlot
    | DeflectionPlot
)
KINDS: dict[str, type[Spec]] = {spec.kind: spec for spec in get_args(Spec)}
"""Kinds of figures by their words in files."""


def dump_specs(specs: Sequence[Spec]) -> str:
    """Specs as text, for a file."""
    return json.dumps([{"kind": spec.kind} | dataclasses.asdict(spec) for spec in specs])


def parse_specs(text: str) -> tuple[Spec, ...]:
    """Specs from a file's text; none from an empty one.

    Raises ``ValueError`` for others.
    """
    return tuple(map(_parse, parsed(text or "[]", tuple[Mapping[str, Any], ...], "figures")))


def _parse(entry: Mapping[str, Any]) -> Spec:
    kind = structured(str, entry.get("kind"), "figures.kind")
    if kind not in KINDS:
        raise ValueError(f"figures: unknown kind {kind!r}; valid: {', '.join(KINDS)}")
    fields = {name: value for name, value in entry.items() if name != "kind"}
    found: Spec = structured(KINDS[kind], fields, "figures")
    return found
