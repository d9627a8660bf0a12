"""The campaign on a real Slurm: the same bits as here, and no loss when a job is ended.

A part of it in every run; the whole smoke budget and a walltime, some minutes on two idle cores,
by `NEOL_CLUSTER=whole pytest tests/cluster`.
"""

import importlib.util
import itertools
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.rollout import make_engine
from neol.run.checkpoint import read_checkpoint
from neol.run.record_file import read_record
from neol.run.single import run_seed
from neol.run.workspace import partial_folder
from neol.spec.configuration import Configuration, load_configuration
from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.grid import RESULTS, Block, blocks, run_specs
from neol.study.campaign.shown import select
from tests.cluster.slurm import missing, slurm
from tests.workflow.clone import fresh_clone

WHOLE = os.environ.get("NEOL_CLUSTER") == "whole"
LACKS = missing()
if importlib.util.find_spec("snakemake_executor_plugin_slurm") is None:
    LACKS.append("snakemake-executor-plugin-slurm")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(bool(LACKS), reason=f"no {', '.join(LACKS)}: .ci/install"),
]

LONG = [
    "budget.tasks=[lunar_lander]",
    "budget.methods=[neat]",
    "budget.populations=[50]",
    "budget.seeds=1",
    f"budget.generations={2000 if WHOLE else 200}",
    "tasks.lunar_lander.max_steps=1000",
]
"""Changes that reduce the smoke budget to one run, long enough to be ended in the middle."""

OFTEN = """
import sys
if "--profile" in sys.argv:
    from snakemake_interface_executor_plugins.executors.remote import RemoteExecutor
    always = property(lambda self: 2, lambda self, seconds: None)
    RemoteExecutor.next_seconds_between_status_checks = always
"""
"""Makes snakemake ask every two seconds; by default it waits ten more if no job has ended."""

SMOKE = select("smoke")
Environment = dict[str, str]


@pytest.fixture(scope="module")
def cluster() -> Iterator[Environment]:
    with slurm() as environment:
        yield environment


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    clone = fresh_clone(tmp_path_factory.mktemp("cluster") / "neol")
    (clone / "sitecustomize.py").write_text(OFTEN)
    return clone


def submit(clone: Path, cluster: Environment, *arguments: str) -> subprocess.Popen[bytes]:
    """Start the workflow of a clone on the cluster; it asks often how its jobs are."""
    command = [sys.executable, "-m", "snakemake", "--profile", "profiles/slurm", *arguments]
    command += ["--latency-wait", "5"]
    command += ["--slurm-status-command", "squeue", "--slurm-init-seconds-before-status-checks=1"]
    with said_by(clone).open("w") as said:  # a pipe that nobody empties would stop it
        environment = cluster | {"PYTHONPATH": str(clone)}
        return subprocess.Popen(command, cwd=clone, env=environment, stdout=said, stderr=said)


def said_by(clone: Path) -> Path:
    """What its last workflow has said."""
    return clone.with_name("said")


def succeeds(workflow: subprocess.Popen[bytes], clone: Path) -> str:
    """What a workflow has said when it is done."""
    workflow.wait()
    said = said_by(clone).read_text()
    assert workflow.returncode == 0, said
    return said


def different(clone: Path, configuration: Configuration, some: list[Block]) -> list[str]:
    """The runs of the clone's records whose trajectory is not that of the same run made here."""
    found = []
    for block in some:
        specs = run_specs(configuration, block)
        with closing(make_engine(specs[0].task)) as engine:
            record = read_record(clone / RESULTS / block.record)
            for spec, info in zip(specs, record.seeds, strict=True):
                if info.digest != run_seed(spec, engine).digest:
                    found.append(f"{block.record} seed {spec.seed}")
    return found


def sample() -> list[Block]:
    """A block of each method; all tasks are among them."""
    wanted = list(zip(SMOKE.budget.methods, itertools.cycle(SMOKE.budget.tasks), strict=False))
    chosen = {(block.cell.method, block.cell.task): block for block in blocks(SMOKE)}
    assert {task for _, task in wanted} == set(SMOKE.budget.tasks)
    return [chosen[each] for each in wanted]


def test_a_campaign_has_the_same_digests_as_here(clone: Path, cluster: Environment) -> None:
    some = blocks(SMOKE) if WHOLE else sample()
    records = [RESULTS / block.record for block in some]
    succeeds(
        submit(clone, cluster, *map(str, records), "--config", "budget=smoke"),
        clone,
    )
    assert different(clone, SMOKE, some) == []
    left = [
        path
        for path in (clone / "results" / DEFAULT_READING / "smoke").rglob("*")
        if path.is_file()
    ]
    assert sorted(left) == sorted(clone / record for record in records)


class Watch:
    """How far the blocks of a campaign are, by the checkpoints that they keep."""

    def __init__(self, clone: Path) -> None:
        self.configuration = _long_budget(clone)
        self.blocks = blocks(self.configuration)
        self.clone = clone
        self.seen: dict[tuple[Path, int], list[int]] = {}
        """Generations of checkpoints that were seen, by block and seed."""

    def look(self) -> None:
        for block in self.blocks:
            folder = partial_folder(self.clone / RESULTS / block.record)
            for spec in run_specs(self.configuration, block):
                path = folder / f"seed_{spec.seed:06}.npz"
                with suppress(UserError):  # not there, or no longer
                    evolution, _ = read_checkpoint(path, spec)
                    self.seen.setdefault((block.record, spec.seed), []).append(evolution.generation)

    def until(self, workflow: subprocess.Popen[bytes], true: Callable[[], bool]) -> None:
        while workflow.poll() is None and not true():
            self.look()
            time.sleep(0.3)

    def never_back(self) -> bool:
        return all(seen == sorted(seen) for seen in self.seen.values())


def _long_budget(clone: Path) -> Configuration:
    """Give the clone a budget of long runs, and no records of it."""
    configuration = load_configuration("smoke", LONG, reading=DEFAULT_READING)
    content = configuration.model_dump(mode="json", include={"budget", "tasks", "evaluation"})
    for named in (content["budget"], *content["tasks"].values()):
        del named["name"]
    (clone / "config" / "long.yaml").write_text(json.dumps(content))
    shutil.rmtree(clone / "results" / DEFAULT_READING / "long", ignore_errors=True)
    budget = configuration.budget.model_copy(update={"name": "long"})
    return configuration.model_copy(update={"budget": budget})


def test_nothing_is_lost_when_running_jobs_are_cancelled(clone: Path, cluster: Environment) -> None:
    watch = Watch(clone)
    workflow = submit(clone, cluster, "records", "--config", "budget=long")
    watch.until(workflow, lambda: len(watch.seen) == len(watch.blocks))
    subprocess.run(["scancel", "--state=RUNNING", "--me"], env=cluster, check=True)
    watch.until(workflow, lambda: False)
    said = succeeds(workflow, clone)
    assert said.count("Trying to restart job") == len(watch.blocks)
    assert watch.never_back(), watch.seen
    assert different(clone, watch.configuration, watch.blocks) == []


@pytest.mark.skipif(not WHOLE, reason="minutes: NEOL_CLUSTER=whole")
def test_a_job_that_hits_its_walltime_goes_on(clone: Path, cluster: Environment) -> None:
    watch = Watch(clone)
    # Without the signal beforehand, which may come a minute early.
    limit = ["--set-resources", "run:runtime=1", "--default-resources", "runtime=1"]
    workflow = submit(
        clone, cluster, "records", "--config", "budget=long", "--retries", "10", *limit
    )
    watch.until(workflow, lambda: False)
    said = succeeds(workflow, clone)
    assert said.count("Trying to restart job") >= len(watch.blocks)
    assert watch.never_back(), watch.seen
    assert different(clone, watch.configuration, watch.blocks) == []
