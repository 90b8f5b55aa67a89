"""Histories in the containers of other libraries, and as rows: an instant each, with units in the
head.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..base.arrays import Array
from ..base.table_writers import head
from ..errors import LagrangeCasadiError
from .derivatives import Derivatives, derivatives
from .histories import Histories

if TYPE_CHECKING:
    import pandas
    import xarray

TIME = "t [s]"
"""The head of the instants."""


def dataset(histories: Histories, sensitivities: Derivatives) -> xarray.Dataset:
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
            histories.array(q),
            {"units": histories.unit(q)} | q.meant(histories.table).attributes,
        )
        for q in histories.quantities()
    }
    for found in derivatives(histories, sensitivities):
        data[found.name] = (
            found.output.quantity.axes,
            found.values,
            {"units": found.unit} | found.attributes,
        )
    coordinates = {
        "t": ("t", histories.t, {"units": "s"}),
        "xi": ("xi", histories.xi, {"units": "1", "long_name": "ratio xi/l"}),
    }
    if histories.over:
        coordinates["over"] = (
            "t",
            histories.over.values,
            {"units": histories.over.unit, "long_name": histories.over.long_name},
        )
    return xarray.Dataset(data, coordinates, {"case": histories.case})


def frame(histories: Histories, sensitivities: Derivatives) -> pandas.DataFrame:
    """All quantities as a ``pandas.DataFrame``, a row an instant.

    Raises :class:`.LagrangeCasadiError` without pandas.
    """
    try:
        import pandas
    except ImportError:
        raise LagrangeCasadiError(
            "to_pandas needs pandas; install it with: pip install pandas"
        ) from None
    return pandas.DataFrame(
        columns(histories, sensitivities), index=pandas.Index(histories.t, name=TIME)
    )


def columns(histories: Histories, sensitivities: Derivatives) -> dict[str, Array]:
    """All quantities over the instants, (t,), by a head with the unit: ``effort:O [N m]``.

    A section force has a column for each ratio: ``section:LINK:bending xi/l=0.25 [N m]``.
    """
    found: dict[str, Array] = {}
    if histories.over:
        found[head(f"over:{histories.over.joint}", histories.over.unit)] = histories.over.values
    named = [
        (str(output), histories.unit(output), histories.array(output))
        for output in histories.quantities()
    ]
    named += [
        (found.name, found.unit, found.values) for found in derivatives(histories, sensitivities)
    ]
    for output, unit, values in named:
        if values.ndim == 1:
            found[head(output, unit)] = values
        else:
            found |= {
                head(f"{output} xi/l={xi:.10g}", unit): column
                for xi, column in zip(histories.xi, values.T, strict=True)
            }
    return found
