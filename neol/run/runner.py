"""Runner: a block of seeds into one record.

While a block runs, `<output>.partial/` holds a record for each finished seed and a checkpoint of
the seed in progress; at the end `<output>` replaces it.
"""

import contextlib
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from neol.base.errors import UserError
from neol.rollout import Engine, EngineName, make_engine
from neol.run.provenance import checkout, provenance
from neol.run.record import Champion, HeldOut, Record, SeedInfo, history_table, join
from neol.run.record_file import (
    RecordMetadata,
    first_difference,
    most_seeds,
    read_footer,
    read_record,
    write_record,
)
from neol.run.single import OnGeneration, SeedResult, run_seed
from neol.run.workspace import checkpoint_path, claim, finished_path, partial_folder
from neol.spec.run_spec import RunSpec
from neol.spec.types import LARGEST_SEED


class Label(NamedTuple):
    """Names of a block's constants; each may be missing."""

    budget: str | None = None
    reading: str | None = None

    def __str__(self) -> str:
        """Return words such as "budget smoke and no reading"."""
        names = self._asdict().items()
        return " and ".join(f"{kind} {name}" if name else f"no {kind}" for kind, name in names)


def run_block(
    spec: RunSpec,
    seeds: Sequence[int],
    output: Path,
    *,
    engine: EngineName = "auto",
    workers: int = 1,
    checkpoint_every: int = 10,
    resume: bool = False,
    keep_partial: bool = False,
    budget: str | None = None,
    reading: str | None = None,
    on_generation: OnGeneration | None = None,
) -> Record:
    """Run a specification with several seeds (its own is not used) and write their record.

    With `resume`, finished seeds and checkpoints of an earlier attempt are used, a complete record
    is returned unchanged, and the call waits for another process at the same output; without it,
    each of these is an error. With `keep_partial`, the records of the single seeds are kept.
    Raises UserError for an obstacle, before anything is simulated.
    """
    checkout()
    seeds, label = _distinct(seeds), Label(budget, reading)
    if output.is_dir():
        raise UserError(f"{output}: is a folder; name a file in it")
    record = _complete(output, spec, seeds, label, resume)
    if record is not None and not partial_folder(output).exists():
        return record
    with claim(output, wait=resume, keep=keep_partial) as workspace:
        # Another process may have finished it meanwhile.
        record = _complete(output, spec, seeds, label, resume)
        if record is None:
            if any(workspace.glob("seed_*")) and not resume:
                raise UserError(
                    f"{workspace}: has an interrupted run; continue with --resume, or remove it"
                )
            _refuse_too_many_seeds(output, spec, seeds)
            _refuse_other_work(workspace, spec, seeds, label)
            with contextlib.closing(make_engine(spec.task, engine, workers)) as player:
                records = [
                    _seed_record(
                        spec.model_copy(update={"seed": seed}),
                        player,
                        workspace,
                        checkpoint_every,
                        label,
                        on_generation,
                    )
                    for seed in seeds
                ]
            record = join(records)
            write_record(output, record, scratch=workspace)
    return record


def evolve(
    spec: RunSpec,
    seeds: Sequence[int] | None = None,
    *,
    engine: EngineName = "auto",
    workers: int = 1,
    on_generation: OnGeneration | None = None,
) -> Record:
    """Run a specification with its own seed or the given ones, and keep the record in memory.

    Use `run_block` for runs that may be interrupted. Raises UserError for an impossible task, an
    empty list of seeds, a repeated seed and one out of range.
    """
    checkout()
    seeds = _distinct([spec.seed] if seeds is None else seeds)
    with contextlib.closing(make_engine(spec.task, engine, workers)) as player:
        specs = [spec.model_copy(update={"seed": seed}) for seed in seeds]
        results = [run_seed(each, player, on_generation=on_generation) for each in specs]
    return join([_record_of(result, Label()) for result in results])


def _complete(
    output: Path, spec: RunSpec, seeds: Sequence[int], label: Label, resume: bool
) -> Record | None:
    """Return the existing record, or None. Raises UserError for one without `resume`."""
    if not output.exists():
        return None
    if not resume:
        raise UserError(f"{output}: already exists; remove it or choose another output")
    record = _same_seeds(read_record(output, spec), seeds, output)
    _refuse_other_label(output, record, label, "choose another output")
    return record


def _seed_record(
    spec: RunSpec,
    engine: Engine,
    workspace: Path,
    checkpoint_every: int,
    label: Label,
    on_generation: OnGeneration | None,
) -> Record:
    """Return the record of one seed: the finished one if it exists, otherwise a new one."""
    finished = finished_path(workspace, spec.seed)
    checkpoint = checkpoint_path(workspace, spec.seed)
    if finished.exists():
        record = _same_seeds(read_record(finished, spec), [spec.seed], finished)
    else:
        result = run_seed(
            spec,
            engine,
            checkpoint=checkpoint,
            checkpoint_every=checkpoint_every,
            on_generation=on_generation,
        )
        record = _record_of(result, label)
        write_record(finished, record)
    checkpoint.unlink(missing_ok=True)
    return record


def _record_of(result: SeedResult, label: Label) -> Record:
    info = SeedInfo(
        seed=result.spec.seed,
        digest=result.digest,
        inputs=result.inputs,
        outputs=result.outputs,
        champion=Champion.of(result.champion),
        held_out=HeldOut.of(result.held_out_returns),
        engine=result.engine,
        wall_seconds=result.past.wall_seconds,
        cpu_seconds=result.past.cpu_seconds,
        provenance=provenance().after(result.past.provenance),
    )
    table = history_table(info.seed, result.history)
    return Record(result.spec, *label, table, (info,))


def _distinct(seeds: Sequence[int]) -> list[int]:
    """Sort seeds. Raises UserError for an empty list, a repeated seed and one out of range."""
    ordered = sorted(map(int, seeds))
    if not ordered or len(set(ordered)) < len(ordered):
        raise UserError(f"seeds {ordered}: give at least one, each once")
    if not 0 <= ordered[0] <= ordered[-1] <= LARGEST_SEED:
        raise UserError(f"seeds {ordered}: give integers from 0 to {LARGEST_SEED}")
    return ordered


def _refuse_too_many_seeds(output: Path, spec: RunSpec, seeds: Sequence[int]) -> None:
    if len(seeds) > (most := most_seeds(spec)):
        raise UserError(
            f"{output}: {len(seeds)} seeds with {spec.evaluation.held_out_episodes} held-out "
            f"episodes each may be too large for one record; run at most {most} seeds at a time"
        )


def _refuse_other_work(workspace: Path, spec: RunSpec, seeds: Sequence[int], label: Label) -> None:
    ours = {finished_path(workspace, seed).stem for seed in seeds}
    others = sorted({path.stem for path in workspace.glob("seed_*")} - ours)
    if others:
        raise UserError(
            f"{workspace}: contains {others[0]}, which is not among the requested seeds; "
            "resume with all its seeds, or move the others to another output's .partial folder"
        )
    for path in sorted(workspace.glob("seed_*.parquet")):
        footer = read_footer(path)
        if difference := first_difference(footer.spec, spec):
            raise UserError(
                f"{path}: of another specification: {difference}; "
                f"restore that value, or remove {workspace}"
            )
        _refuse_other_label(path, footer, label, f"remove {workspace}")


def _refuse_other_label(
    path: Path, made: Record | RecordMetadata, label: Label, way_out: str
) -> None:
    """Raise UserError for a record whose constants were named differently."""
    stored = Label(made.budget, made.reading)
    if stored != label:
        raise UserError(f"{path}: made with {stored}, not {label}; name those, or {way_out}")


def _same_seeds(record: Record, seeds: Sequence[int], path: Path) -> Record:
    found = [info.seed for info in record.seeds]
    if found != list(seeds):
        raise UserError(
            f"{path}: contains seeds {found}, not {list(seeds)}; remove it or choose another output"
        )
    return record
