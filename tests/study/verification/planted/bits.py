"""Bits and bytes of a record; the manifest stays as it was."""

from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from tests.study.verification.campaign import OJA
from tests.study.verification.planted.plant import Plant


def flip(marker: bytes, offset: int = 0, bit: int = 0) -> Callable[[Path], None]:
    """Flip a bit near the last place where some bytes stand."""

    def do(folder: Path) -> None:
        content = bytearray((folder / OJA).read_bytes())
        content[(content.rindex(marker) + offset) % len(content)] ^= 1 << bit
        (folder / OJA).write_bytes(content)

    return do


def flip_value(folder: Path) -> None:
    """Flip a bit of the last value of the column best_fitness."""
    column = pq.read_metadata(folder / OJA).row_group(0).column(2)
    content = bytearray((folder / OJA).read_bytes())
    content[column.data_page_offset + column.total_compressed_size - 1] ^= 1
    (folder / OJA).write_bytes(content)


def rewrite(change: Callable[[bytes], bytes]) -> Callable[[Path], object]:
    """Change a file's bytes."""
    return lambda folder: (folder / OJA).write_bytes(change((folder / OJA).read_bytes()))


def foreign(folder: Path) -> None:
    pq.write_table(pa.table({"a": [1, 2]}), folder / OJA)


BYTES = [
    Plant("a bit of the opening magic flipped", rewrite(lambda old: b"Q" + old[1:])),
    Plant("a bit of a page's header flipped", rewrite(lambda old: old[:6] + b"\xff" + old[7:])),
    Plant("a bit of a column's values flipped", flip_value),
    Plant("a bit of the metadata flipped", flip(b'"fitness":', 12)),
    Plant("a bit of the record's digest flipped", flip(b"neol_digest", 20)),
    Plant("a bit of the stored schema flipped", flip(b"ARROW:schema", 40)),
    Plant("a bit of the writer's name flipped", flip(b"parquet-cpp", 1)),
    Plant("a bit of the footer's length flipped", flip(b"PAR1", -4)),
    Plant("a bit of the closing magic flipped", flip(b"PAR1", 3)),
    Plant("truncated in the middle", rewrite(lambda old: old[: len(old) // 2])),
    Plant("the last byte lost", rewrite(lambda old: old[:-1])),
    Plant("bytes appended", rewrite(lambda old: old + b"PAR1")),
    Plant("bytes put in front", rewrite(lambda old: b"\0" + old)),
    Plant("emptied", rewrite(lambda _: b"")),
    Plant("replaced by text", rewrite(lambda _: b"seed,generation\n0,1\n")),
    Plant("replaced by another Parquet file", foreign),
]
