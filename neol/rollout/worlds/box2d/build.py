"""Build the C++ core: `python -m neol.rollout.worlds.box2d.build`.

Fetches Box2D's source through pip by its hash, compiles it with the core into one library beside
this file, and keeps that only if it plays as Gymnasium does on this machine. Where any of this
fails it says so in one line and exits with 0: the reference engine serves.
"""

import contextlib
import ctypes
import hashlib
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import gymnasium
import numpy as np

from neol.base.errors import UserError
from neol.base.files import cache_folder, write_atomically
from neol.random.pcg64 import seed_pcg64
from neol.rollout.worlds.box2d.library import FLAGS, FOLDER, LIBRARY, LOCK, TASKS, load, stamp

COMPILER_FAILED = "the C++ compiler failed"
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion")
SANITIZE = (
    "-std=c++17",
    "-Og",
    "-g1",
    "-fno-access-control",
    "-fsanitize=address,undefined",
    "-fno-sanitize=null,vptr",  # of these the first crashes anyway; both compile slowly
    "-fno-sanitize-recover=all",
)
"""Instead of FLAGS: the core as the tests run it, each bad access and undefined result fatal."""


class BuildError(Exception):
    """Why there is no core: one line."""


def find_compiler() -> list[str]:
    """The C++ compiler's command: $CXX or the first of the usual names."""
    if os.environ.get("CXX"):
        return shlex.split(os.environ["CXX"])
    for name in ("c++", "g++", "clang++"):
        if path := shutil.which(name):
            return [path]
    raise BuildError("no C++ compiler was found")


def fetch_source(folder: Path) -> Path:
    """Unpack Box2D's source into a folder. Its archive is kept in the user's cache."""
    expected = re.findall(r"--hash=sha256:(\w+)", LOCK.read_text())[0]
    archive = cache_folder() / f"box2d-{expected[:16]}.tar.gz"
    content = archive.read_bytes() if archive.exists() else b""
    if hashlib.sha256(content).hexdigest() != expected:
        download = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps"]
        download += ["--no-binary", ":all:", "--require-hashes", "--requirement", str(LOCK)]
        _run([*download, "--dest", str(folder)], "pip could not fetch Box2D's source")
        (downloaded,) = folder.glob("*.tar.gz")
        content = downloaded.read_bytes()
        with contextlib.suppress(UserError):  # a cache that cannot be written
            write_atomically(archive, content)
    with tarfile.open(fileobj=io.BytesIO(content)) as tar:
        tar.extractall(folder, filter="data")
    (source,) = folder.glob("*/Box2D/Box2D.h")
    return source.parent.parent


def compile_core(flags: Sequence[str], output: Path, *extra_sources: Path) -> None:
    """Compile the core and all of Box2D, the latter as one unit and as a system's header.

    A header in stub/ is in place of Box2D's own, and of the unit of its name. `flags` are the
    compiler's and the linker's.
    """
    compiler = find_compiler()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        source = fetch_source(folder)
        stub = FOLDER / "stub"
        units = sorted(path.relative_to(source) for path in source.glob("Box2D/**/*.cpp"))
        units = [unit for unit in units if not (stub / unit).with_suffix(".h").exists()]
        box2d = folder / "box2d.cpp"
        box2d.write_text("".join(f"#include <{unit.as_posix()}>\n" for unit in units))
        headers = ["-I", str(FOLDER), "-isystem", str(stub), "-isystem", str(source)]
        definition = f'-DNEOL_STAMP="{stamp()}"'
        command = [*compiler, *flags, *headers, definition]

        def compile_unit(unit: Path) -> Path:
            result = folder / f"{unit.stem}.o"
            warnings = ("-w",) if unit == box2d else WARNINGS
            _run([*command, *warnings, "-c", str(unit), "-o", str(result)], COMPILER_FAILED)
            return result

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            objects = list(pool.map(compile_unit, [box2d, *FOLDER.glob("*.cpp"), *extra_sources]))
        _run([*compiler, *flags, *map(str, objects), "-o", str(output)], COMPILER_FAILED)


def build() -> bool:
    """Build the library where it is missing or out of date: whether there was anything to do."""
    if not isinstance(load(LIBRARY), str):
        return False
    candidate = LIBRARY.with_name(f".{os.getpid()}.{LIBRARY.name}")
    try:
        compile_core([*FLAGS, "-shared"], candidate)
        library = load(candidate)
        if isinstance(library, str):
            raise BuildError(library)
        for environment in TASKS:
            if not plays_like_gymnasium(library, environment):
                raise BuildError(f"on this machine {environment} would not equal Gymnasium's")
        candidate.replace(LIBRARY)
    except OSError as error:
        raise BuildError(str(error)) from None
    finally:
        candidate.unlink(missing_ok=True)
    return True


def plays_like_gymnasium(library: ctypes.CDLL, environment: str) -> bool:
    """Whether a few episodes with random actions come out the same, bit for bit."""
    simulation = library.neol_create(TASKS.index(environment))
    try:
        return all(_equal_episode(library, simulation, environment, seed) for seed in range(3))
    finally:
        library.neol_destroy(simulation)


def _equal_episode(library: ctypes.CDLL, simulation: int, environment: str, seed: int) -> bool:
    peer = gymnasium.make(environment, max_episode_steps=200, disable_env_checker=True)
    peer.action_space.seed(seed)
    expected, _ = peer.reset(seed=seed)
    random = np.empty(4, dtype=np.uint64)
    observation, reward = np.empty(expected.shape), np.empty(1)
    seed_pcg64(np.uint64(seed), random)
    library.neol_reset(simulation, random.ctypes.data, observation.ctypes.data)
    equal: bool = observation.tolist() == expected.tolist()
    done = False
    while equal and not done:
        action = peer.action_space.sample()
        numbers = np.atleast_1d(action).astype(np.float32)
        expected, expected_reward, terminated, truncated, _ = peer.step(action)
        ended = library.neol_step(
            simulation, numbers.ctypes.data, observation.ctypes.data, reward.ctypes.data
        )
        equal = observation.tolist() == expected.tolist() and (
            (reward[0], ended) == (float(expected_reward), terminated)
        )
        done = terminated or truncated
    return equal


def _run(command: Sequence[str], failure: str) -> None:
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode:
        errors = [line for line in result.stderr.splitlines() if "error" in line.lower()]
        raise BuildError(f"{failure} ({errors[0].strip()})" if errors else failure)


def main() -> None:
    try:
        if build():
            print(f"Built {LIBRARY.name}, the C++ core of LunarLander and BipedalWalker")
    except BuildError as error:
        print(
            f"C++ core not built: {error}; LunarLander and BipedalWalker use the reference engine "
            "(same results, more time)"
        )


if __name__ == "__main__":
    main()
