"""Pictures that a page holds: small, and the same to look at."""

import io

import numpy as np
from PIL import Image, ImageSequence

from neol.study.report.embedding import FRAMES, WIDTH, short_gif, small_png


def test_a_picture_fits_the_page_and_keeps_its_shape() -> None:
    image = Image.fromarray(np.full((300, 2 * WIDTH, 3), (200, 30, 30), np.uint8))
    buffer = io.BytesIO()
    image.save(buffer, format="png")
    small = Image.open(io.BytesIO(small_png(buffer.getvalue())))
    assert small.size == (WIDTH, 150)
    assert small.convert("RGB").getpixel((10, 10)) == (200, 30, 30)


def _film(frames: int) -> bytes:
    pictures = [
        Image.fromarray(np.full((8, 8, 3), (i % 256, i // 256, 0), np.uint8)) for i in range(frames)
    ]
    buffer = io.BytesIO()
    first, *others = pictures
    first.save(buffer, format="gif", save_all=True, append_images=others, duration=40, loop=0)
    return buffer.getvalue()


def test_a_long_film_takes_as_long_with_fewer_frames() -> None:
    long = _film(2 * FRAMES + 1)
    short = Image.open(io.BytesIO(short_gif(long)))
    durations = [frame.info["duration"] for frame in ImageSequence.Iterator(short)]
    assert len(durations) <= FRAMES
    assert sum(durations) == 40 * (2 * FRAMES + 1)


def test_a_short_film_stays_as_it_is() -> None:
    film = _film(5)
    assert short_gif(film) is film
