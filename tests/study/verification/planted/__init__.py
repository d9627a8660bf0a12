"""Errors to plant in a small campaign's folder, by what they are planted in."""

from tests.study.verification.planted.bits import BYTES
from tests.study.verification.planted.contents import CONTENTS
from tests.study.verification.planted.files import FILES
from tests.study.verification.planted.manifest import MANIFEST

PLANTS = {
    "Bytes of a record": BYTES,
    "Contents of a record, with all hashes computed again": CONTENTS,
    "Files of a budget's folder": FILES,
    "The manifest": MANIFEST,
}
