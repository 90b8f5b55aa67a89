"""A scene over its instants, as users ask for it. What does it is imported when it is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated

from ..base.arguments import LATER, Outputs, ThreadCount, public
from ..base.vocabulary import Backend, Precision
from ..engine.instants.evaluation_method import EvaluationMethod
from ..model.even_points import EvenPoints
from ..model.scene import Scene
from ..model.scene_arguments import Elastic
from ..model.times import Over, Times
from .request import Request

if TYPE_CHECKING:
    from ..results.solution import Solution


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

    The method is that of Nguyen, Petre, Stroe, *Application of Lagrange equations for calculus of
    internal forces in a mechanism*; ``docs/method.md`` follows it step by step.

    Parameters
    ----------
    scene
        The scene.
    parameters
        Values that replace defaults, by name; for a parameter in rad also a text such as
        ``"30 deg"``. The scene is not compiled again for them if the defaults can be assembled.
    t, xi
        Start, stop and count of the instants [s] and of the section ratios xi/l.
    over
        Instants in equal steps of a driven coordinate, in place of ``t``: see :class:`.Scene`.
    wanted
        Output names; with ``sensitivity`` or ``sensitivity:PARAMETER`` among them also the
        derivatives of all others by all parameters or by some: see :class:`.Derivatives`.
    backend, precision, newton, table, flags
        Method of evaluation: see :class:`.EvaluationMethod`.
    threads
        Number of threads that share the instants; default: one a core. The result does not depend
        on it.
    certificate
        Check the solution by :mod:`.certificate`, as far as the wanted outputs allow, and estimate
        its errors by :mod:`.accuracy`.
    elastic
        Determine statically indeterminate forces by least strain energy: see :class:`.Scene`.

    Returns
    -------
    Solution
        Arrays over the instants (t,), section forces (t, xi), in SI units; :mod:`.base.tables`
        lists units and signs. If the certificate fails, the solution is not
        :attr:`~.Solution.certified`, and :class:`CertificateWarning` is given.

    Raises
    ------
    AssemblyError
        If a loop cannot be closed at some instant.
    SizeError
        If the outputs over time do not fit into memory.
    CompilerError
        If a backend needs a compiler, and there is none or it fails.
    UnknownNameError, ParameterError, DeclarationError
        For mistakes in the arguments.
    """
    method = EvaluationMethod(backend, precision, newton, table, flags)
    request = Request(parameters, t, over, xi, wanted, method)
    from .solving import solve

    return solve(scene, request, threads=threads, certificate=certificate, elastic=elastic)
