"""The core as a file: refused if stale, absent without a compiler, clean under sanitizers."""

import ctypes
import shutil
import subprocess
from pathlib import Path

import pytest

from neol.rollout.worlds.box2d import build
from neol.rollout.worlds.box2d import library as core

NOTHING: list[Path] = []
SANITIZE = (
    "-std=c++17",
    "-Og",
    "-g1",
    "-fno-access-control",
    "-fsanitize=address,undefined",
    "-fno-sanitize=null,vptr",  # null crashes without it; both are slow to compile
    "-fno-sanitize-recover=all",
)
"""Flags that replace the core's own: bad access and undefined behaviour are fatal."""


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an empty folder for the library."""
    folder = tmp_path / "library"
    folder.mkdir()
    monkeypatch.setattr(build, "LIBRARY", folder / core.LIBRARY.name)
    return folder


def notice(capsys: pytest.CaptureFixture[str]) -> str:
    """Build; return the one line that is printed."""
    build.main()
    (line,) = capsys.readouterr().out.splitlines()
    return line


@pytest.mark.parametrize("source", ["pcg64.hpp", "stub/Python.h", "stub/Box2D/Common/b2Timer.h"])
def test_a_library_of_other_sources_is_refused(
    source: str, library: ctypes.CDLL, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = shutil.copytree(core.FOLDER, tmp_path / "box2d")
    monkeypatch.setattr(core, "FOLDER", folder)
    assert isinstance(core.load(), ctypes.CDLL)
    with (folder / source).open("a") as file:
        file.write("\n")
    assert "out of date" in str(core.load())
    assert core.stamp().encode() != library.neol_stamp()


def test_a_library_of_other_flags_is_refused(
    library: ctypes.CDLL, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert core.stamp().encode() == library.neol_stamp()
    monkeypatch.setattr(core, "FLAGS", ("-O2",))
    assert "out of date" in str(core.load())


def test_no_library_and_none_that_loads(tmp_path: Path) -> None:
    assert "not built" in str(core.load(tmp_path / "core.so"))
    (tmp_path / "core.so").write_text("nonsense")
    assert "out of date" in str(core.load(tmp_path / "core.so"))
    (tmp_path / "core.so").write_text(core.stamp())
    assert "cannot be loaded" in str(core.load(tmp_path / "core.so"))


def test_no_compiler(
    elsewhere: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("CXX", raising=False)
    monkeypatch.setenv("PATH", str(elsewhere))
    assert "no C++ compiler was found; " in notice(capsys)
    assert list(elsewhere.iterdir()) == NOTHING


@pytest.mark.usefixtures("library")
def test_a_compiler_that_fails(
    elsewhere: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CXX", "false")
    assert "the C++ compiler failed; " in notice(capsys)
    assert list(elsewhere.iterdir()) == NOTHING


@pytest.mark.slow
def test_no_source(
    elsewhere: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("CXX", "true")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(elsewhere))
    assert "pip could not fetch Box2D's source" in notice(capsys)
    assert list(elsewhere.iterdir()) == NOTHING


@pytest.mark.slow
@pytest.mark.usefixtures("library")
def test_only_a_library_that_plays_like_gymnasium_is_kept(
    elsewhere: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def copy(_flags: object, output: Path) -> None:
        shutil.copy(core.LIBRARY, output)

    monkeypatch.setattr(build, "compile_core", copy)
    with monkeypatch.context() as patch:
        patch.setattr(build, "TASKS", core.TASKS[::-1])
        with pytest.raises(build.BuildError, match="would differ from Gymnasium's"):
            build.build()
    assert list(elsewhere.iterdir()) == NOTHING
    assert build.build()
    assert [path.name for path in elsewhere.iterdir()] == [core.LIBRARY.name]
    assert not build.build()


@pytest.mark.slow
@pytest.mark.usefixtures("compiler")
def test_no_warnings(tmp_path: Path) -> None:
    build.compile_core([*core.FLAGS, "-shared", "-Werror"], tmp_path / "core")


@pytest.mark.slow
def test_clean_under_sanitizers(library: ctypes.CDLL, tmp_path: Path) -> None:
    program = tmp_path / "episodes"
    build.compile_core(SANITIZE, program, Path(__file__).with_name("episodes.cpp"))
    run = subprocess.run([program], capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, ""), run.stderr
    played = len(core.TASKS) * len(core.available_paths(library))
    assert [int(steps) > 5000 for steps in run.stdout.split()] == [True] * played
