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
        Set a parameter, in SI units or with a unit, as l=0.25 or phi=30deg.

        Values by names of parameters, instead of their defaults; one in rad may be a text, as ``"30
        deg"``. The scene is not compiled again for them if the defaults can be assembled.
    t
        Set the instants [s], both ends included; default: those of the scene.

        Start, stop and count.
    xi
        Set the ratios xi/l at which sections are stored, within 0 (base) and 1 (tip); default:
        those of the scene.
    over
        Set the instants as equal steps of a driven joint's coordinate [rad or m, or with a unit, as
        720deg], in place of ``t``.

        Joint, start, stop and count: see :class:`.Scene`.
    wanted
        Compute these outputs: effort, reaction:JOINT, section:LINK, motion, a kind such as section,
        or all; default: those of the scene.

        With ``sensitivity`` or ``sensitivity:PARAMETER`` among them also the derivatives of all
        others by all parameters or by some: see :class:`.Derivatives`.
    backend, precision, newton, table, flags
        Method of evaluation: see :class:`.EvaluationMethod`.
    threads
        Use this number of threads; default: one per core.

        The result does not depend on it.
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
