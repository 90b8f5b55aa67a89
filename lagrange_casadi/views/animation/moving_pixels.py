"""The GIF and the MP4 that the frames of a picture make."""

from __future__ import annotations

import io
import itertools
import shutil
import subprocess
import tempfile
from contextlib import suppress
from pathlib import Path

import numpy as np

from ...base.space import require
from ...errors import LagrangeCasadiError, StoreError, one_line
from ..shapes.picture_sheet import Picture
from ..shapes.pixels import frames

_COLOURS = 128
"""Number of colours of a GIF: more are not visible, and take space."""

_SAMPLES = 6
"""Frames from which the colours of a GIF are taken."""

_WHITE = 248
"""Least brightness that counts as white: a mean of light colours is not white."""


def gif(picture: Picture, seconds: float) -> bytes:
    """An animation that repeats for ever.

    Raises :class:`.SizeError` where memory does not hold it.
    """
    from PIL import Image

    require("a GIF", (picture.frames, picture.height, picture.width // 8))
    chosen = np.unique(np.linspace(0, picture.frames - 1, _SAMPLES).astype(int)).tolist()
    sample = Image.fromarray(np.concatenate([np.asarray(one) for one in frames(picture, chosen)]))
    palette = sample.quantize(_COLOURS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    colours = np.array(palette.getpalette())
    light = np.min(colours.reshape(-1, 3), axis=1) >= _WHITE
    palette.putpalette(np.where(np.repeat(light, 3), 255, colours).tolist())
    flat = (one.quantize(palette=palette, dither=Image.Dither.NONE) for one in frames(picture))
    # A GIF counts hundredths of a second; those of all frames are together those of the cycle.
    ends = np.round(100.0 * seconds * np.arange(picture.frames + 1) / picture.frames).astype(int)
    times = [max(20, 10 * int(stop - start)) for start, stop in itertools.pairwise(ends)]
    file = io.BytesIO()
    first = next(flat)
    first.save(file, "GIF", save_all=True, append_images=flat, duration=times, loop=0)
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


def mp4(picture: Picture, seconds: float) -> bytes:
    """A film of H.264, a cycle of so many seconds.

    Raises :class:`.StoreError` where ffmpeg fails.
    """
    size, rate = f"{picture.width}x{picture.height}", f"{picture.frames / seconds:.17g}"
    command = [
        *(find_ffmpeg(), "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24"),
        *("-s", size, "-r", rate, "-i", "-", "-an", "-c:v", "libx264", "-crf", "18"),
        *("-pix_fmt", "yuv420p", "-movflags", "+faststart"),
        # The same bytes each time.
        *("-threads", "1", "-map_metadata", "-1", "-fflags", "+bitexact", "-flags:v", "+bitexact"),
        *("-f", "mp4"),
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
