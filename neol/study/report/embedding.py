"""Pictures made small enough that a page can hold many of them.

The files that they come from keep their full size; the page links to them.
"""

import io

from PIL import Image, ImageSequence

WIDTH = 1000
"""Pixels; the page is no wider."""
COLOURS = 48
"""Colours of a picture's palette, enough for lines, marks and their smooth edges."""
FRAMES = 400
"""Frames of a film above which every second one is left out, or two of three, and so on."""


def small_png(png: bytes) -> bytes:
    """Return a picture no wider than `WIDTH` with a palette of its own, as PNG."""
    image = Image.open(io.BytesIO(png)).convert("RGB")
    if image.width > WIDTH:
        height = round(image.height * WIDTH / image.width)
        image = image.resize((WIDTH, height), Image.Resampling.LANCZOS)
    buffer = io.BytesIO()
    palette = image.quantize(COLOURS, dither=Image.Dither.NONE)
    palette.save(buffer, format="png", optimize=True)
    return buffer.getvalue()


def short_gif(gif: bytes) -> bytes:
    """Return a film of the same length in time with at most `FRAMES` frames, as GIF."""
    film = Image.open(io.BytesIO(gif))
    count = getattr(film, "n_frames", 1)
    if count <= FRAMES:
        return gif
    stride = -(-count // FRAMES)
    kept, shown = [], []
    for i, frame in enumerate(ImageSequence.Iterator(film)):
        duration = frame.info["duration"]
        if i % stride == 0:
            kept.append(frame.copy())
            shown.append(duration)
        else:
            shown[-1] += duration
    buffer = io.BytesIO()
    first, *others = kept
    first.save(buffer, format="gif", save_all=True, append_images=others, duration=shown, loop=0)
    return buffer.getvalue()
