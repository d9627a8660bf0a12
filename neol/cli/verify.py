"""Commands that check records: digests, manifest, verification, replays of runs."""

import math
import secrets
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from neol.cli.application import DISAGREES, RecordPath, app, examples, refuse_exhibits

if TYPE_CHECKING:
    from neol.study.verification.check import Problem
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
        "neol manifest results/first/paper --tasks cartpole",
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
    if count and cells:
        summary.append(_repeat(cells, count, minutes, generations, seed, log, findings))
    if replay_champions and cells:
        summary.append(_repeat_champions(cells, replay_champions, seed + 1, findings))
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


def _repeat(
    cells: "dict[Run, str]",
    count: int,
    minutes: float | None,
    generations: int | None,
    seed: int,
    log: Path | None,
    findings: "list[Problem]",
) -> str:
    """Repeat drawn runs and compare; return a summary of what was repeated and its coverage."""
    from neol.study.verification import replays
    from neol.study.verification.replay_log import ReplayLog

    deadline = math.inf if minutes is None else time.monotonic() + 60 * minutes
    known = ReplayLog(log) if log else None
    whole = known.among(cells) if known else set()
    before, repeated, done = len(whole), 0, 0
    drawn = [run for run in replays.draw(cells, seed) if run not in whole][:count]
    for number, run in enumerate(drawn, 1):
        if time.monotonic() >= deadline:
            break
        title = f"replay {number} of {len(drawn)}"
        played = _played(partial(replays.replay, run, generations, deadline), run, title, findings)
        if played is None:
            continue
        repeated, done = repeated + 1, done + played.generations
        if played.whole:
            whole.add(run)
            if known and not played.problem:
                known.add(run)
    parts = [f"{_plural(repeated, 'run')} repeated", _plural(done, "generation")]
    if before:
        parts.append(f"{before:,} repeated before")
    return ", ".join([*parts, str(replays.coverage(cells, whole))])


def _repeat_champions(
    cells: "dict[Run, str]", count: int, seed: int, findings: "list[Problem]"
) -> str:
    """Repeat the held-out episodes of drawn champions; return a summary."""
    from neol.study.verification import replays

    drawn = replays.draw(cells, seed)[:count]
    played = [
        _played(partial(replays.replay_champion, run), run, f"champion {number}", findings)
        for number, run in enumerate(drawn, 1)
    ]
    return f"{_plural(len(played) - played.count(None), 'champion')} played again"


def _played(
    play: "Callable[[], Replay]", run: "Run", title: str, findings: "list[Problem]"
) -> "Replay | None":
    """Make a replay, print and add its problem; return None if it cannot be made."""
    from neol.base.errors import UserError
    from neol.cli.progress import Display
    from neol.study.verification.check import Problem

    played = None
    try:
        with Display() as display:
            display.show(title)
            played = play()
        problem = played.problem
    except UserError as error:
        problem = Problem(run[0], f"cannot be repeated: {error}", run[1])
    if problem:
        print(problem, flush=True)
        findings.append(problem)
    return played


def _plural(number: int, one: str) -> str:
    return f"{number:,} {one}{'s' * (number != 1)}"
