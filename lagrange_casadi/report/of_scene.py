"""A page of a scene: evaluated with all that the page shows, and alive where that is asked for."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence

from ..declare.scene import Scene
from ..studies.evaluate import evaluate
from .live import Live, run_of
from .page import write_report


def scene_report(
    scene: Scene,
    path: str | os.PathLike[str],
    parameters: Mapping[str, float] | None,
    wanted: Sequence[str] | None,
    live: bool,
) -> None:
    """Evaluate a scene and write its page: see :meth:`.Scene.report`."""
    scene.wants(wanted)
    asked = with_motion(scene.wanted if wanted is None else wanted)
    engine = Live.of(scene, scene.timing(), asked, run_of(scene.name), parameters) if live else None
    write_report(
        evaluate(scene, parameters=parameters, wanted=asked, elastic=False if live else None),
        path,
        engine,
    )


def with_motion(wanted: Sequence[str]) -> list[str]:
    """Wanted outputs with motion, without which nothing can be shown."""
    return list(wanted) if {"all", "motion"} & set(wanted) else [*wanted, "motion"]
