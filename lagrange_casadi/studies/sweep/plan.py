"""A sweep before it runs: which designs, what is kept of them, and the words that distinguish it
from other sweeps.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypedDict, cast

from ...base.arrays import Array, as_json, spread
from ...base.space import in_words, require
from ...base.vocabulary import KEEPS, Keep, PeakSearch, Precision
from ...engine.derive import compile_scene, derived
from ...errors import (
    AssemblyError,
    DeclarationError,
    MobilityError,
    ParameterError,
    SizeError,
    check_known,
)
from ...model.even_points import checked_ratios
from ...model.scene import STRENGTH, Scene
from ...model.wanted_names import SENSITIVITY, among, by_parameters, without_fitted
from ..designs.engine import DesignEngine
from ..designs.spot_check import wanted_whole
from ..request import Request
from .axes import Designs, check_designs, counted, filled
from .columns import Harvest
from .design_blocks import Slab, chunk_of, slabs

_Bound = float | str
"""Start or end of instants: a number, or an expression of parameters in words."""


class Identity(TypedDict):
    """Inputs of every number of a sweep, as its file keeps them: its tuples are JSON's lists."""

    case: str
    versions: dict[str, str]
    sources: str
    backend: str
    precision: Precision
    compiler: str
    flags: str
    rung: str
    keep: Keep
    scene: str
    wanted: dict[str, Any]
    t: tuple[_Bound, _Bound, int] | tuple[_Bound, _Bound, int, str, _Bound]
    xi: tuple[float, float, int] | None
    mechanism: dict[str, Any]
    grid: dict[str, str]


MANY, MOST = 10**9, 10**12
"""Designs beyond which a sweep must be meant, and beyond which it cannot be."""

_LONG, _LARGE = 600.0, 10**10
"""Seconds of a core, and bytes, of which nothing need be said."""

_FEW, _SHARES = 1 << 11, 12
_TRIED = 64
"""Designs that are tried where the defaults cannot be assembled."""

_LARGEST = 1 << 31
"""Bytes of a chunk of the file."""

_TIMES = 4
"""Number of copies of a design's results in memory before they are written."""


@dataclass(frozen=True, eq=False)
class Plan:
    """A sweep before it runs; ``values`` are those of all parameters, the swept ones at their
    defaults.

    ``case_file`` is the file of the case that is swept, as written in the sweep's file.
    """

    designs: Designs
    values: Mapping[str, float]
    harvest: Harvest
    case_file: str = ""

    @classmethod
    def of(
        cls,
        scene: Scene,
        designs: Designs,
        request: Request,
        keep: Keep = "peaks",
        *,
        peaks: PeakSearch = "exact",
        fluctuation: bool = False,
        many: bool = False,
    ) -> Plan:
        """Check everything that can be before anything is evaluated.

        Raises what :func:`.sweep` does.
        """
        fixed, method = request.parameters or {}, request.method
        check_known("choice of what to keep", [str(keep)], KEEPS)
        check_designs(designs, scene.parameters, fixed)
        values, timing = scene.values(fixed), scene.timing(request.t, request.over)
        if designs.size > MOST:
            raise DeclarationError(
                f"the grid has {counted(designs.size)}, and a sweep at most 10^12"
            )
        if designs.size > MANY and not many:
            raise DeclarationError(
                f"the grid has {counted(designs.size)}, more than 10^9; if that is meant, say"
                " many=True"
            )
        names = _wanted(scene, request.wanted)
        ratios = None if request.xi is None else checked_ratios(request.xi)
        assembly = _assembly(scene, designs, values, names)
        program = compile_scene(scene, names, parameters=assembly)
        content, named = program.data.content, [name for name in names if name != "all"]
        without_fitted(content.fitted, names, "sweeps")
        safety, life = (tuple(among(kind, content.beams, named)) for kind in ("safety", "life"))
        by = by_parameters(program.data.parameters, names)
        if peaks != "exact" and (safety or life or by):
            raise DeclarationError(
                "peaks: safety, life and sensitivity need exact ones; leave them out of wanted="
            )
        scene.checked(scene.values())
        whole = compile_scene(scene, wanted_whole(program.outputs), parameters=assembly)
        engine = DesignEngine.compiled(program, timing, method, peaks)
        harvest = Harvest(engine, whole, ratios, keep, safety, life, by, fluctuation)
        largest = max(harvest.columns, key=lambda column: column.width)
        if largest.width > _LARGEST:
            size = f"{largest.width / 2**30:.3g} GiB"
            raise SizeError(
                f"{largest.name} of one design takes {size}, a chunk 2 GiB at most: ask for fewer"
                " instants or ratios"
            )
        require(
            "a design and what it is made from",
            (_TIMES, sum(column.width for column in harvest.columns) // 8),
        )
        return cls(designs, values, harvest)

    @property
    def size(self) -> int:
        """Number of designs."""
        return self.designs.size

    @property
    def axes_size(self) -> int:
        """Bytes of the values along the designs' axes."""
        return 8 * sum(self.designs.dimensions.values())

    def takes(self, done: int) -> str:
        """Remaining work after so many designs, in words; empty if it is little."""
        time = (self.size - done) * self.harvest.engine.cost
        # Columns are smaller where they deflate.
        most = self.axes_size + self.size * sum(column.width for column in self.harvest.columns)
        if time < _LONG and most < _LARGE:
            return ""
        return (
            f"{counted(self.size - done)} take about {in_words(time)} of a core and a file of up to"
            f" {most / 1e9:.3g} GB"
        )

    @property
    def dims(self) -> tuple[int, ...]:
        """The lengths of the designs' axes."""
        return tuple(self.designs.dimensions.values())

    @cached_property
    def chunk(self) -> tuple[int, ...]:
        """The lengths of a chunk of the file along these axes: a block."""
        # Some blocks more, where there are few, let workers end together.
        return chunk_of(self.dims, min(self.harvest.block, max(_FEW, self.size // _SHARES)))

    @property
    def capacity(self) -> int:
        """Number of designs in a chunk."""
        return math.prod(self.chunk)

    def slabs(self) -> Iterator[Slab]:
        """All blocks, in order."""
        return slabs(self.dims, self.chunk)

    def block(self, start: int, stop: int) -> Array:
        """Designs by number, of shape (designs, parameters): all parameters in the order of
        declaration.
        """
        return filled(self.values, self.designs.names, self.designs.block(start, stop))

    @cached_property
    def identity(self) -> Identity:
        """Inputs of all numbers of the sweep, in plain words: no clock, no path, nothing of how it
        is run.
        """
        words = {
            "case": self.harvest.data.name,
            **self.harvest.signature,
            "mechanism": self.harvest.data.at(list(self.values.values())).plain(),
            "grid": self.designs.describe(),
        }
        return cast(Identity, as_json(words))


def _assembly(
    scene: Scene, designs: Designs, values: Mapping[str, float], wanted: Sequence[str]
) -> Mapping[str, float] | None:
    """Return values with which a scene is assembled: its own, None; else those of the first of some
    designs that can be.

    Raises what :func:`.derived` does for the scene's own where there is none.
    """
    try:
        derived(scene, wanted, None)
    except (AssemblyError, MobilityError):
        for number in spread(designs.size, _TRIED):
            row = designs.block(int(number), int(number) + 1)[0].tolist()
            tried = {**values, **dict(zip(designs.names, row, strict=True))}
            try:
                derived(scene, wanted, scene.values(tried))
            except (AssemblyError, DeclarationError, ParameterError):
                continue
            return tried
        raise
    return None


def _wanted(scene: Scene, wanted: Sequence[str] | None) -> tuple[str, ...]:
    """Output names; ``all`` are all but the motion, whose peaks size nothing, and strength, which
    is wanted by name.
    """
    scene.wants(wanted)
    names = tuple(scene.wanted if wanted is None else wanted)
    if "all" not in names or "motion" in names:
        return names
    user_outputs = (
        name for name in scene.outputs if name.partition(":")[0] not in (*STRENGTH, SENSITIVITY)
    )
    strength = (name for name in names if name.partition(":")[0] in STRENGTH)
    slopes = (f"{SENSITIVITY}:{name}" for name in by_parameters(scene.parameters, names))
    return (*(name for name in user_outputs if name not in ("all", "motion")), *strength, *slopes)
