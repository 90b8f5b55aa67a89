"""Frames as pixels, and the GIF and the MP4 that they make."""

from __future__ import annotations

import io
import itertools
import shutil
import subprocess
import tempfile
import warnings
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ...base.arrays import Array
from ...base.space import require
from ...errors import LagrangeCasadiError, StoreError, one_line
from ..shapes.pictures import one_at_a_time
from .drawn import INK, Dot, Picture, Thing, Words

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

_DOTS = 100.0
"""Pixels an inch."""

_SAMPLES = 6
"""Frames from which the colours of a GIF are taken."""

_COLOURS = 128
"""Number of colours of a GIF: more are not visible, and take space."""

_WHITE = 248
"""Least brightness that counts as white."""

Pixels = npt.NDArray[np.uint8]


def frames(picture: Picture, chosen: Iterable[int] | None = None) -> Iterator[Pixels]:
    """The frames (height, width, 3), all or those that are ``chosen`` by number."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(
        figsize=(picture.width / _DOTS, picture.height / _DOTS), dpi=_DOTS, facecolor="white"
    )
    canvas: Any = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, picture.width), ylim=(picture.height, 0.0))
    axes.set_axis_off()
    artists = [
        (thing, _artist(axes, thing, picture.unit, order))
        for order, thing in enumerate(picture.things)
    ]
    for k in range(picture.frames) if chosen is None else chosen:
        for thing, artist in artists:
            _move(artist, thing, thing.points[min(k, len(thing.points) - 1)])
        with one_at_a_time(), warnings.catch_warnings():
            warnings.filterwarnings(
                "ignore", "Glyph", UserWarning
            )  # a name may have letters that no font has
            canvas.draw()
        yield np.asarray(canvas.buffer_rgba())[..., :3].copy()


def gif(picture: Picture, seconds: float) -> bytes:
    """An animation that repeats for ever.

    Raises :class:`.SizeError` where memory does not hold it.
    """
    from PIL import Image

    require("a GIF", (picture.frames, picture.height, picture.width // 8))
    chosen = np.unique(np.linspace(0, picture.frames - 1, _SAMPLES).astype(int)).tolist()
    sheet = Image.fromarray(np.concatenate(list(frames(picture, chosen))))
    palette = sheet.quantize(_COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    taken = np.array(palette.getpalette()).reshape(-1, 3)
    taken[np.min(taken, axis=1) >= _WHITE] = 255  # a mean of light colours is not white
    palette.putpalette(taken.ravel().tolist())
    flat = (
        Image.fromarray(one).quantize(palette=palette, dither=Image.Dither.NONE)
        for one in frames(picture)
    )
    # A GIF counts hundredths of a second; those of all frames are together those of the cycle.
    ends = np.round(100.0 * seconds * np.arange(picture.frames + 1) / picture.frames).astype(int)
    times = [max(20, 10 * int(stop - start)) for start, stop in itertools.pairwise(ends)]
    file = io.BytesIO()
    next(flat).save(
        file, "GIF", save_all=True, append_images=flat, duration=times, loop=0, optimize=False
    )
    return file.getvalue()


def find_ffmpeg() -> str:
    """Find the program that makes an MP4.

    Raises :class:`.LagrangeCasadiError` where it is not found.
    """
    found = shutil.which("ffmpeg")
    if found is None:
        raise LagrangeCasadiError(
            "an MP4 is made by ffmpeg, which is not found; install it, or write a .gif or an .svg"
        )
    return found


def mp4(picture: Picture, rate: float) -> bytes:
    """A film of H.264, with so many frames a second.

    Raises :class:`.StoreError` where ffmpeg fails.
    """
    size = f"{picture.width}x{picture.height}"
    taken = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", f"{rate:.17g}", "-i", "-"]
    made = [
        "-an",
        "-c:v",
        "libx264",
        "-crf",
        "18",
        "-pix_fmt",
        "yuv420p",
        "-movflags",
        "+faststart",
    ]
    plain = [
        "-threads",
        "1",
        "-map_metadata",
        "-1",
        "-fflags",
        "+bitexact",
        "-flags:v",
        "+bitexact",
    ]  # the same bytes
    command = [
        find_ffmpeg(),
        "-v",
        "error",
        "-y",
        *taken,
        *made,
        *plain,
        "-f",
        "mp4",
    ]
    with tempfile.TemporaryFile() as words, tempfile.TemporaryDirectory() as work:
        path = Path(work) / "film.mp4"
        try:
            with subprocess.Popen(
                [*command, str(path)], stdin=subprocess.PIPE, stdout=words, stderr=words
            ) as running:
                assert running.stdin is not None
                with suppress(BrokenPipeError), running.stdin as film:  # what ended early says why
                    for one in frames(picture):
                        film.write(one.tobytes())
        except OSError as error:
            raise StoreError(f"ffmpeg cannot be run: {one_line(error)}") from None
        if running.returncode:
            words.seek(0)
            said = words.read().decode(errors="replace").strip().splitlines()
            raise StoreError(
                f"ffmpeg failed: {said[-1] if said else f'status {running.returncode}'}"
            )
        return path.read_bytes()


def _artist(axes: Axes, thing: Thing, unit: float, order: int) -> Artist:
    from matplotlib.colors import to_rgba
    from matplotlib.lines import Line2D
    from matplotlib.patches import Circle, Polygon
    from matplotlib.patheffects import withStroke

    point = 72.0 / _DOTS
    style: dict[str, Any]
    if isinstance(thing, Words):
        style = {
            "ha": "right" if thing.before else "left",
            "va": "baseline",
            "parse_math": False,
            "zorder": order,
        }
        halo = [withStroke(linewidth=3.0 * unit * point, foreground="white")]
        return axes.text(
            0.0,
            0.0,
            thing.text,
            fontsize=13.0 * unit * point,
            color=INK,
            path_effects=halo,
            **style,
        )
    if isinstance(thing, Dot):
        circle = Circle(
            (0.0, 0.0),
            thing.radius,
            facecolor=thing.fill,
            edgecolor=INK,
            linewidth=1.5 * unit * point,
            zorder=order,
        )
        return axes.add_patch(circle)
    if thing.closed:
        fill = to_rgba(thing.fill, thing.opacity) if thing.fill else "none"
        style = {
            "facecolor": fill,
            "edgecolor": thing.colour,
            "linewidth": thing.width * point,
            "joinstyle": "round",
        }
        return axes.add_patch(Polygon(np.zeros((3, 2)), closed=True, zorder=order, **style))
    dashes = (0, (4.0, 3.0)) if thing.dashed else "-"
    style = {"solid_capstyle": "round", "solid_joinstyle": "round", "linestyle": dashes}
    return axes.add_line(
        Line2D([], [], color=thing.colour, linewidth=thing.width * point, zorder=order, **style)
    )


def _move(artist: Any, thing: Thing, points: Array) -> None:
    if isinstance(thing, Words):
        artist.set_position(points)
    elif isinstance(thing, Dot):
        artist.set_center(points)
    elif thing.closed:
        artist.set_xy(points)
    else:
        artist.set_data(points.T)
