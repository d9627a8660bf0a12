"""Build the C++ core: `python -m neol.rollout.worlds.box2d.build`.

It fetches Box2D's source through pip by its hash, compiles it with the core into one library beside
this file, and keeps the library only if it plays exactly as Gymnasium does on this machine. A
failure is reported in one line with exit code 0, because the reference engine gives the same
results.
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
from typing import NamedTuple

import gymnasium
import numpy as np
import numpy.typing as npt

from neol.base.errors import UserError
from neol.base.files import cache_folder, write_atomically
from neol.random.pcg64 import seed_pcg64
from neol.rollout.worlds.box2d.library import (
    FLAGS,
    FOLDER,
    LANES,
    LIBRARY,
    LOCK,
    PATHS,
    TASKS,
    available_paths,
    load,
    stamp,
)

COMPILER_FAILED = "the C++ compiler failed"
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion")

EPISODES, STEPS = 20, 100
"""Episodes that must equal Gymnasium's, more than a vector holds, and their largest length."""


class BuildError(Exception):
    """The core cannot be built; the message is one line."""


def find_compiler() -> list[str]:
    """Return the C++ compiler's command: $CXX, or the first of the usual names."""
    if os.environ.get("CXX"):
        return shlex.split(os.environ["CXX"])
    for name in ("c++", "g++", "clang++"):
        if path := shutil.which(name):
            return [path]
    raise BuildError("no C++ compiler was found")


def fetch_source(folder: Path) -> Path:
    """Unpack Box2D's source into a folder; keep its archive in the user's cache."""
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
    """Compile the core and Box2D, which is one unit and included as a system header.

    A header in stub/ replaces Box2D's own header and the unit of the same name. `flags` are those
    of the compiler and the linker.
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

        def compile_unit(unit: Path, *extra_flags: str) -> str:
            result = str(folder / f"{'-'.join([unit.stem, *extra_flags])}.o")
            warnings = ("-w",) if unit == box2d else WARNINGS
            final = [*warnings, *extra_flags, "-c", str(unit), "-o", result]
            _run([*command, *final], COMPILER_FAILED)
            return result

        jobs: list[tuple[Path | str, ...]] = [(FOLDER / "lanes.cpp", *kind) for kind in LANES]
        jobs += [(unit,) for unit in (box2d, *FOLDER.glob("*.cpp"), *extra_sources)]
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            objects = list(pool.map(lambda job: compile_unit(*job), jobs))
        _run([*compiler, *flags, *objects, "-o", str(output)], COMPILER_FAILED)


def build() -> bool:
    """Build the library if it is missing or out of date; return whether it was built."""
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
                raise BuildError(f"on this machine {environment} would differ from Gymnasium's")
        candidate.replace(LIBRARY)
    except OSError as error:
        raise BuildError(str(error)) from None
    finally:
        candidate.unlink(missing_ok=True)
    return True


class _Episode(NamedTuple):
    """An episode in Gymnasium with random actions: one row for each step."""

    first: npt.NDArray[np.float32]
    """First observation, before any step."""
    actions: list[npt.NDArray[np.float32]]
    observations: list[list[float]]
    rewards: list[float]
    ends: list[bool]


def plays_like_gymnasium(library: ctypes.CDLL, environment: str) -> bool:
    """Whether episodes with random actions are equal on every path, bit for bit."""
    episodes = [_gymnasium_episode(environment, seed) for seed in range(EPISODES)]
    return all(_equal(library, environment, path, episodes) for path in available_paths(library))


def _gymnasium_episode(environment: str, seed: int) -> _Episode:
    peer = gymnasium.make(environment, max_episode_steps=STEPS, disable_env_checker=True)
    peer.action_space.seed(seed)
    first, _ = peer.reset(seed=seed)
    episode, done = _Episode(first, [], [], [], []), False
    while not done:
        action = peer.action_space.sample()
        observation, reward, terminated, truncated, _ = peer.step(action)
        episode.actions.append(np.atleast_1d(action).astype(np.float32))
        episode.observations.append(observation.tolist())
        episode.rewards.append(float(reward))
        episode.ends.append(terminated)
        done = terminated or truncated
    return episode


def _equal(library: ctypes.CDLL, environment: str, path: str, episodes: Sequence[_Episode]) -> bool:
    """Whether a group of the core reproduces these episodes, of seeds from 0, side by side."""
    slots = len(episodes)
    action = np.zeros((slots, 4), dtype=np.float32)
    observation = np.empty((slots, len(episodes[0].first)))
    reward, ended = np.empty(slots), np.empty(slots, dtype=np.bool_)
    random = np.empty(4, dtype=np.uint64)
    group = library.neol_create(TASKS.index(environment), slots, PATHS.index(path))
    try:
        for slot, episode in enumerate(episodes):
            seed_pcg64(np.uint64(slot), random)
            library.neol_reset(group, slot, random.ctypes.data, observation[slot].ctypes.data)
            if observation[slot].tolist() != episode.first.tolist():
                return False
        for step in range(STEPS):
            playing = [slot for slot in range(slots) if step < len(episodes[slot].ends)]
            for slot in playing:
                numbers = episodes[slot].actions[step]
                action[slot, : len(numbers)] = numbers
            arrays = (np.array(playing), action, observation, reward, ended)
            library.neol_step(group, len(playing), *(array.ctypes.data for array in arrays))
            for slot in playing:
                episode = episodes[slot]
                if (
                    observation[slot].tolist() != episode.observations[step]
                    or reward[slot] != episode.rewards[step]
                    or ended[slot] != episode.ends[step]
                ):
                    return False
    finally:
        library.neol_destroy(group)
    return True


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
