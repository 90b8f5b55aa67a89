"""A scene over its instants, as users ask for it. What does it is imported when it is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated

from ..arguments import LATER, Outputs, ThreadCount, public
from ..base.vocabulary import Backend, Precision
from ..declare.compliant import Elastic
from ..declare.even_points import EvenPoints
from ..declare.scene import Scene
from ..declare.times import Over, Times
from ..instants.evaluation_method import EvaluationMethod
from .request import Request

if TYPE_CHECKING:
    from ..instants.solution import Solution


@public
def evaluate(
    scene: Scene,
    *,
    parameters: Mapping[str, float] | None = None,
    t: Times | None = None,
    over: Over | None = None,
    xi: EvenPoints | None = None,
    wanted: Outputs | None = None,
    backend: Backend = "auto",
    precision: Precision = "double",
    newton: Annotated[int | None, LATER] = None,
    table: Annotated[float | None, LATER] = None,
    flags: Annotated[str, LATER] = "",
    threads: ThreadCount | None = None,
    certificate: bool = True,
    elastic: Elastic | None = None,
) -> Solution:
    """Evaluate a scene, with its own grids and outputs or with others.

    Parameters
    ----------
    parameters
        Values that replace defaults, by name; of a parameter in rad a text such as ``"30 deg"``
        too. Nothing is derived or compiled again for them where the defaults can be assembled.
    t, xi
        Start, stop and count of the instants [s] and of the section ratios xi/l.
    over
        Instants in equal steps of a driven coordinate, in place of ``t``: see :class:`.Scene`.
    wanted
        Output names; with ``sensitivity`` or ``sensitivity:PARAMETER`` among them the derivatives
        of all others too, by all parameters or by some: see :class:`.Derivatives`.
    backend, precision, newton, table, flags
        How it is evaluated: see :class:`.EvaluationMethod`.
    threads
        How many threads share the instants; default: one a core. The result does not depend on it.
    certificate
        Whether to check the solution by :mod:`.certificate`, as far as the wanted outputs allow,
        and to estimate its errors by :mod:`.accuracy`.
    elastic
        Whether least strain energy tells what equilibrium leaves open: see :class:`.Scene`.

    Notes ----- Returns the :class:`.Solution`: arrays over the instants (t,), section forces (t,
    xi), in SI units; :mod:`.base.tables` lists units and signs. A solution whose certificate fails
    says so: it is not :attr:`~.Solution.certified`, and :class:`CertificateWarning` is given. The
    method is that of Nguyen, Petre, Stroe, *Application of Lagrange equations for calculus of
    internal forces in a mechanism*; ``docs/method.md`` follows it step by step.

    Raises :class:`AssemblyError` where a loop does not close at some instant, :class:`SizeError`
    where the outputs over time do not fit into memory, :class:`CompilerError`, and for mistakes in
    the arguments :class:`UnknownNameError`, :class:`ParameterError` or :class:`DeclarationError`.
    """
    method = EvaluationMethod(backend, precision, newton, table, flags)
    request = Request(parameters, t, over, xi, wanted, method)
    from .solving import solve

    return solve(scene, request, threads=threads, certificate=certificate, elastic=elastic)
