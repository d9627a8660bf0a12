"""What is fetched while an environment or CI is set up is pinned by hash."""

import re
from pathlib import Path

import pytest

from neol.spec.configuration import ROOT

LOCKS = (
    "environment.lock",
    "build.lock",
    "lock.lock",
    "benchmarks/requirements.lock",
    "benchmarks/neat_python_092.lock",
)


def test_every_package_of_a_lock_has_a_hash() -> None:
    for name in LOCKS:
        text = (ROOT / name).read_text().replace("\\\n", " ")
        packages = [line for line in text.splitlines() if line and not line.startswith("#")]
        assert packages
        assert all("==" in line and "--hash=sha256:" in line for line in packages), name


@pytest.mark.parametrize(("name", "count"), [("Makefile", 6), ("postBuild", 3)])
def test_nothing_is_installed_without_a_hash(name: str, count: int) -> None:
    text = (ROOT / name).read_text().replace("\\\n", " ")
    installs = [line for line in text.splitlines() if re.search(r"pip\b.* install ", f"{line} ")]
    assert len(installs) == count
    for line in installs:
        editable = "--no-deps --no-build-isolation --editable ." in line
        assert editable or "--require-hashes" in line, line
    (locked,) = (line for line in installs if "--requirement environment.lock" in line)
    assert "--no-build-isolation" in locked


def test_conda_installs_no_package_of_python() -> None:
    assert "- pip:" not in (ROOT / "environment.yml").read_text()


def test_actions_are_pinned_by_commit() -> None:
    workflows = sorted(Path(ROOT, ".github", "workflows").glob("*.yml"))
    used = [each for path in workflows for each in re.findall(r"uses: (\S+)", path.read_text())]
    assert used
    assert all(re.fullmatch(r"[\w./-]+@[0-9a-f]{40}", each) for each in used)
