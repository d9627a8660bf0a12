"""Each path of the physics against Box2D's own loop: all that worlds hold, bit for bit."""

import subprocess
from pathlib import Path

import pytest

from neol.rollout.worlds.box2d import build
from neol.rollout.worlds.box2d import library as core
from tests.helpers.core import require_compiler

PATHS = ("shortcut", "sse2", "avx2", "avx512", "neon")
LANDER, WALKER, HARDCORE = range(3)


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program of paths.cpp, compiled as the core is."""
    require_compiler()
    output = tmp_path_factory.mktemp("paths") / "paths"
    build.compile_core(core.FLAGS, output, Path(__file__).with_name("paths.cpp"))
    return output


def play(program: Path, *arguments: object) -> list[str]:
    """Play on a path: the words that the program prints."""
    command = [str(program), *map(str, arguments)]
    result = subprocess.run(command, capture_output=True, text=True)
    if result.stdout == "unavailable\n":
        pytest.skip("this machine does not have that path")
    assert (result.returncode, result.stderr) == (0, ""), result.stdout + result.stderr
    return result.stdout.split()


@pytest.mark.slow
@pytest.mark.parametrize("size", [1, 3, 8, 32])
@pytest.mark.parametrize("task", [LANDER, WALKER, HARDCORE])
@pytest.mark.parametrize("path", PATHS)
def test_a_path_has_the_bits_of_box2d(program: Path, path: str, task: int, size: int) -> None:
    """Episodes of unequal ages in a batch; some of the walkers fail an assertion of Box2D."""
    steps = (6400 if task == LANDER else 3200) // size
    compared, failed, played = play(program, path, task, size, steps, 180, 5)
    assert int(compared) + int(failed) == steps * size
    assert (int(failed) > 0) == (task != LANDER and size >= 3)
    assert played == path


@pytest.mark.slow
@pytest.mark.parametrize("task", [LANDER, WALKER, HARDCORE])
@pytest.mark.parametrize("path", PATHS)
def test_one_iteration_less_is_seen(program: Path, path: str, task: int) -> None:
    """The negative control: 179 velocity iterations instead of 180 differ."""
    with pytest.raises(AssertionError, match="instead of"):
        play(program, path, task, 8, 100, 179, 1)


@pytest.mark.slow
@pytest.mark.parametrize("path", ["avx2", "avx512"])
def test_sines_are_those_of_the_c_library(program: Path, path: str) -> None:
    """Each angle in the range of the lanes, both signs: 333 million."""
    compared, different = play(program, "sines", path)
    assert int(compared) > 333e6
    assert int(different) == 0
