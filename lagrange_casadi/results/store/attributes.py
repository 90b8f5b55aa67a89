"""Attributes of the file of a run: they are held to one rule when they are written and read."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeAlias

from ...base.arrays import Json
from ...base.quantities import Output
from ...engine.instants.beyond_equilibrium import Elasticity
from ...engine.instants.evaluation_method import Provenance
from ...model.description import Description
from ..solution import Solution
from .dataset_words import conventions
from .specs import Spec, parse_specs
from .untrusted import number, parsed, shown, structured

Attributes: TypeAlias = Mapping[str, Any]
"""Texts and numbers of a file, by name."""

_NAMES = tuple[str, ...]

_PROVENANCE = {key: key for key in ("backend", "precision", "compiler", "flags")} | {
    "rung": "method"
}
"""Field of the provenance that each attribute of a file holds."""


def attributes_to_write(solution: Solution, figures: str, grids: Sequence[str]) -> Attributes:
    """Attributes of the file of a solution, with section grids of the links ``grids``; those of the
    datasets are apart.

    Raises ``ValueError``, ``TypeError`` or ``KeyError`` for attributes that a reader refuses.
    """
    structured(Mapping[str, float], dict(solution.errors), "errors")
    provenance, elasticity = solution.provenance, solution.elasticity
    found: dict[str, Any] = {
        "case": solution.case,
        **conventions(solution.table),
        "mechanism": json.dumps(solution.description.plain()),
        "parameters": json.dumps(solution.description.values),
        "certified": solution.certified,
        "certificate_tolerance": solution.tolerance,
        "outputs": json.dumps(list(solution.series)),
    }
    if len(grids) < len(solution.links_with_sections):
        bare = (
            str(Output("section", link, force))
            for link in solution.links_with_sections
            if link not in grids
            for force in solution.table.forces
        )
        estimates = {name: solution.errors[name] for name in bare if name in solution.errors}
        found |= {"grids": json.dumps(list(grids)), "error_estimates": json.dumps(estimates)}
    found["undetermined"] = json.dumps(solution.undetermined)
    if elasticity != Elasticity():
        found["by_elasticity"] = json.dumps(list(map(str, elasticity.completed)))
        found["open_because"] = json.dumps(elasticity.reasons)
    if solution.holding:
        reasons = {name: held.reason for name, held in solution.holding.items()}
        found["holding"] = json.dumps(reasons)
    found["versions"] = json.dumps(dict(provenance.versions))
    stated = {key: getattr(provenance, name) for key, name in _PROVENANCE.items()}
    found |= stated | {"figures": figures}
    fields = read_attributes(found)
    for fault in check_attributes(found, fields["description"]):
        raise ValueError(fault)
    return found


def read_attributes(attributes: Attributes) -> dict[str, Any]:
    """Fields of a :class:`Solution` that attributes of its file state; ``holding`` are reasons.

    Raises ``ValueError``, ``TypeError`` or ``KeyError`` for attributes that are not written.
    """

    def stated(key: str, kind: Any, otherwise: str | None = None) -> Any:
        text = attributes[key] if otherwise is None else attributes.get(key, otherwise)
        return parsed(text, kind, key)

    description: Description = stated("mechanism", Description)
    description.check_places()
    words = {name: shown(attributes[key]) for key, name in _PROVENANCE.items()}
    completed, reasons = (stated(key, _NAMES, "[]") for key in ("by_elasticity", "open_because"))
    return {
        "case": shown(attributes["case"]),
        "description": description,
        "provenance": Provenance(**words, versions=stated("versions", Mapping[str, str])),
        "indeterminate": tuple(map(Output.of, stated("undetermined", _NAMES))),
        "errors": stated("error_estimates", Mapping[str, float], "{}"),
        "tolerance": number(attributes, "certificate_tolerance"),
        "elasticity": Elasticity(tuple(map(Output.of, completed)), reasons),
        "holding": stated("holding", Mapping[str, str], "{}"),
    }


def described(mechanism: Json) -> Description:
    """The mechanism of a file. Raises ``ValueError`` for JSON of another form."""
    found: Description = structured(Description, mechanism, "mechanism")
    return found


def check_attributes(attributes: Attributes, description: Description) -> Iterator[str]:
    """Faults of figures, and of the case and parameters, which the ``description`` has too."""
    try:
        figures_of(attributes)
    except ValueError as error:
        yield str(error)
    if (
        parsed(attributes["parameters"], Mapping[str, float], "parameters") != description.values
        or attributes["case"] != description.name
    ):
        yield "case or parameters: differ from those of the mechanism"


def figures_of(attributes: Attributes) -> tuple[Spec, ...]:
    """Specs of figures in a file. Raises ``ValueError`` if there are others."""
    return parse_specs(shown(attributes.get("figures", "")))
