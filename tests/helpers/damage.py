"""Damage to files: by chance, by mistake, and by careful forgery."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from hypothesis import strategies as st

from neol.run import checkpoint, record_file
from neol.run.checkpoint import Arrays
from neol.run.record import SCHEMA

Json = Any


def forge_record(path: Path, change: Callable[[Json, Json], None]) -> None:
    """Change a record's metadata and rows, and compute its digest again, as a forger would."""
    file = pq.ParquetFile(path)
    metadata, rows = json.loads(file.metadata.metadata[b"neol"]), file.read().to_pydict()
    change(metadata, rows)
    table = pa.table(rows, schema=SCHEMA)
    text = json.dumps(metadata, separators=(",", ":")).encode()  # of anything: also of NaN
    sealed = {"neol": text, "neol_digest": record_file._digest(text, table)}
    pq.write_table(table.replace_schema_metadata(sealed), path)


def forge_checkpoint(path: Path, change: Callable[[Arrays], None]) -> None:
    """Change a checkpoint's arrays, and compute its digest again."""
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files if name != "seal"}
    change(arrays)
    np.savez(path, **arrays, seal=checkpoint._seal(arrays))


HOSTILE = st.one_of(
    st.sampled_from([None, True, -1, 0, 1.5, 1e308, 10**18, 10**30, float("nan"), float("inf")]),
    st.sampled_from(
        ["", "x", "\0", "é\n", "../x", "__import__('os')", "=1+1", [], [[]], {}, {"": 0}]
    ),
    st.text(max_size=5),
)
TOKENS = [
    b"[" * 3000,
    b"{" * 3000,
    b"9" * 5000,
    b"&a ",
    b"*a",
    b"!!python/name:os.system ",
    b"!!int ",
    b"!!float ",
    b"!!bool ",
    b"_",
    b'""',
    b'"\\UFFFFFFFF"',
    b'"\\uD800"',
    b"\0",
    b"\xff",
    b'"',
    b"\n",
    b": ",
    b"- ",
    b"<<: ",
    b"NaN",
    b"-0",
    b"1e999",
    b"null",
    b"\x80\x04.",
    b"PAR1",
    b"PK\x05\x06",
]


@st.composite
def flipped(draw: st.DrawFn, content: bytes) -> bytes:
    """Change one to three bytes of a file."""
    damaged = bytearray(content)
    for _ in range(draw(st.integers(1, 3))):
        damaged[draw(st.integers(0, len(content) - 1))] ^= draw(st.integers(1, 255))
    return bytes(damaged)


@st.composite
def damaged(draw: st.DrawFn, content: bytes) -> bytes:
    """Change, remove, double or insert some bytes of a file."""
    for _ in range(draw(st.integers(1, 3))):
        begin = draw(st.integers(0, len(content)))
        end = min(len(content), begin + draw(st.sampled_from([0, 1, 4, 64, len(content)])))
        part = content[begin:end]
        new = draw(
            st.one_of(
                st.just(part * 2),
                st.just(
                    bytes(byte ^ (1 << draw(st.integers(0, 7))) for byte in part[:1]) + part[1:]
                ),
                st.sampled_from([b"", *TOKENS]),
                st.binary(max_size=8),
            )
        )
        content = content[:begin] + new + content[end:]
    return content


def mistake(draw: st.DrawFn, content: Json) -> Json:
    """Replace a value of JSON, or remove, rename or add a key."""
    if isinstance(content, dict) and content and draw(st.integers(0, 4)):
        key = draw(st.sampled_from(sorted(content)))
        return content | {key: mistake(draw, content[key])}
    if isinstance(content, list) and content and draw(st.integers(0, 4)):
        place = draw(st.integers(0, len(content) - 1))
        return [*content[:place], mistake(draw, content[place]), *content[place + 1 :]]
    if isinstance(content, dict) and content and draw(st.booleans()):
        key = draw(st.sampled_from(sorted(content)))
        return {k: v for k, v in content.items() if k != key} | draw(
            st.sampled_from([{}, {"x": 1}])
        )
    return draw(HOSTILE)
