"""Commands that check records: digests, manifest, verification, replays of runs."""

import math
import secrets
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from neol.cli.application import DISAGREES, RecordPath, app, examples, refuse_exhibits

if TYPE_CHECKING:
    from neol.study.verification.check import Problem
    from neol.study.verification.repetition import Repetition
    from neol.study.verification.replays import Replay, Run


@app.command(epilog=examples("neol digest a.parquet"))
def digest(record: RecordPath) -> None:
    """Print each seed of a record and the digest of its trajectory."""
    from neol.run.record_file import read_record

    for info in read_record(record).seeds:
        print(info.seed, info.digest)


@app.command(
    epilog=examples(
        "neol manifest results/rare_mutation/demo",
        "neol manifest results/rare_mutation/two_by_two",
    )
)
def manifest(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="Folder of one budget's records.")
    ],
    tasks: Annotated[
        str,
        typer.Option(help="Tasks whose records are complete, like cartpole,hopper; default: all."),
    ] = "",
) -> None:
    """Write FOLDER/manifest.json: its records and their digests."""
    from neol.study.verification.manifest import NAME, write_manifest

    written = write_manifest(folder, tasks)
    print(f"{folder / NAME}: {len(written.records)} records")


@app.command(
    epilog=examples(
        "neol verify results",
        "neol verify results/rare_mutation/demo --replay 5",
        "neol verify a.parquet --replay all --log replayed.txt",
    )
)
def verify(
    paths: Annotated[
        list[Path],
        typer.Argument(
            metavar="PATH", help="Records, or folders of records.", callback=refuse_exhibits
        ),
    ],
    replay: Annotated[
        str,
        typer.Option(
            metavar="COUNT", help="Number of runs to repeat to their end, drawn at random, or all."
        ),
    ] = "0",
    minutes: Annotated[
        float | None,
        typer.Option(min=0, help="Time for repeating runs; without --replay, as many runs as fit."),
    ] = None,
    generations: Annotated[
        int | None,
        typer.Option(
            min=1, help="Number of first generations to repeat of each run; default: all."
        ),
    ] = None,
    replay_champions: Annotated[
        int, typer.Option(min=0, help="Number of champions whose held-out episodes are repeated.")
    ] = 0,
    seed: Annotated[
        int | None,
        typer.Option(min=0, help="Seed of the draw; by default one is chosen and printed."),
    ] = None,
    log: Annotated[
        Path | None,
        typer.Option(help="File that lists agreeing runs, which are not repeated again."),
    ] = None,
) -> None:
    """Check records by their digests, rows and manifest; replay runs."""
    from neol.cli.progress import Display
    from neol.study.verification.check import Verification
    from neol.study.verification.repetition import Repetition, repeat_champion
    from neol.study.verification.replay_log import ReplayLog
    from neol.study.verification.replays import draw

    count = _count_of(replay, minutes)
    verification = Verification(paths)
    findings: list[Problem] = []
    cells: dict[Run, str] = {}
    try:
        with Display() as display:
            for number, checked in enumerate(verification.check(), 1):
                findings += checked.findings
                cells |= {(checked.path, each): checked.cell for each in checked.seeds}
                display.show(f"record {number} of {len(verification.records)}")
            findings += verification.manifest_findings()
    finally:
        for finding in findings:
            print(finding, flush=True)
    records = _plural(len(verification.records), "record")
    summary = [f"{records} of {_plural(len(cells), 'run')} checked", *verification.notes()]
    seed = secrets.randbelow(2**32) if seed is None else seed
    made: list[Replay] = []
    if count and cells:
        deadline = math.inf if minutes is None else time.monotonic() + 60 * minutes
        known = ReplayLog(log) if log else None
        repetition = Repetition(cells, count, seed, generations, deadline, known)
        of = f" of {len(repetition.drawn)}"
        made += _play("replay", repetition.runs(), repetition.repeat, of)
        summary.append(_describe(repetition))
    if replay_champions and cells:
        drawn = draw(cells, seed + 1)[:replay_champions]
        champions = list(_play("champion", drawn, repeat_champion))
        played = sum(each.played for each in champions)
        summary.append(f"{_plural(played, 'champion')} played again")
        made += champions
    findings += [each.problem for each in made if each.problem]
    if cells and (count or replay_champions):
        summary[-1] += f" (--seed {seed})"
    outcome = _plural(len(findings), "finding") if findings else "all well"
    print(f"{', '.join(summary)}: {outcome}")
    if findings:
        raise typer.Exit(DISAGREES)


def _count_of(replay: str, minutes: float | None) -> int:
    """Return the largest number of runs to repeat. Raises UserError unless a number or all."""
    from neol.base.errors import UserError

    if replay == "all" or (replay == "0" and minutes is not None):
        return sys.maxsize
    if not (replay.isascii() and replay.isdigit()):
        raise UserError(f'--replay {replay}: give a number of runs, or "all"')
    return int(replay)


def _play(
    title: str, runs: "Iterable[Run]", play: "Callable[[Run], Replay]", of: str = ""
) -> "Iterator[Replay]":
    """Yield replays as they are made; show which is being made, and print what it finds."""
    from neol.cli.progress import Display

    for number, run in enumerate(runs, 1):
        with Display() as display:
            display.show(f"{title} {number}{of}")
            replay = play(run)
        if replay.problem:
            print(replay.problem, flush=True)
        yield replay


def _describe(repetition: "Repetition") -> str:
    """Return a summary of what was repeated and its coverage."""
    parts = [
        f"{_plural(repetition.repeated, 'run')} repeated",
        _plural(repetition.generations_done, "generation"),
    ]
    if repetition.before:
        parts.append(f"{repetition.before:,} repeated before")
    return ", ".join([*parts, str(repetition.coverage())])


def _plural(number: int, one: str) -> str:
    return f"{number:,} {one}{'s' * (number != 1)}"
