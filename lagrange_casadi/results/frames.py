"""A solution in the containers of other libraries, and as rows: an instant each, with units in the
head.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..base.arrays import Array
from ..base.table_file import head
from ..errors import LagrangeCasadiError
from .derivatives import derivatives

if TYPE_CHECKING:
    import pandas
    import xarray

    from .solution import Solution

TIME = "t [s]"
"""The head of the instants."""


def dataset(solution: Solution) -> xarray.Dataset:
    """All quantities as an ``xarray.Dataset`` over t and xi.

    Raises :class:`.LagrangeCasadiError` without xarray.
    """
    try:
        import xarray
    except ImportError:
        raise LagrangeCasadiError(
            "to_xarray needs xarray; install it with: pip install xarray"
        ) from None
    data = {
        str(q): (
            q.quantity.axes,
            solution.array(q),
            {"units": solution.unit(q)} | q.meant(solution.table).attributes,
        )
        for q in solution.quantities()
    }
    for found in derivatives(solution):
        data[found.name] = (
            found.output.quantity.axes,
            found.values,
            {"units": found.unit} | found.attributes,
        )
    coordinates = {
        "t": ("t", solution.t, {"units": "s"}),
        "xi": ("xi", solution.xi, {"units": "1", "long_name": "ratio xi/l"}),
    }
    if solution.over:
        coordinates["over"] = (
            "t",
            solution.over.values,
            {"units": solution.over.unit, "long_name": solution.over.long_name},
        )
    return xarray.Dataset(data, coordinates, {"case": solution.case})


def frame(solution: Solution) -> pandas.DataFrame:
    """All quantities as a ``pandas.DataFrame``, a row an instant.

    Raises :class:`.LagrangeCasadiError` without pandas.
    """
    try:
        import pandas
    except ImportError:
        raise LagrangeCasadiError(
            "to_pandas needs pandas; install it with: pip install pandas"
        ) from None
    return pandas.DataFrame(columns(solution), index=pandas.Index(solution.t, name=TIME))


def columns(solution: Solution) -> dict[str, Array]:
    """All quantities over the instants, (t,), by a head with the unit: ``effort:O [N m]``.

    A section force has a column for each ratio of the solution: ``section:LINK:bending xi/l=0.25 [N
    m]``.
    """
    found: dict[str, Array] = {}
    if solution.over:
        found[head(f"over:{solution.over.joint}", solution.over.unit)] = solution.over.values
    named = [
        (str(output), solution.unit(output), solution.array(output))
        for output in solution.quantities()
    ]
    named += [(found.name, found.unit, found.values) for found in derivatives(solution)]
    for output, unit, values in named:
        if values.ndim == 1:
            found[head(output, unit)] = values
        else:
            found |= {
                head(f"{output} xi/l={xi:.10g}", unit): column
                for xi, column in zip(solution.xi, values.T, strict=True)
            }
    return found
