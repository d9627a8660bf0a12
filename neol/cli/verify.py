"""Whether records are what they say: digests, manifest, verification, replays of their runs."""

import secrets
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from neol.cli.application import DISAGREES, app, examples

if TYPE_CHECKING:
    from neol.study.verification.check import Problem
    from neol.study.verification.replays import Run


@app.command(epilog=examples("neol digest a.parquet"))
def digest(record: Annotated[Path, typer.Argument(metavar="RECORD", help="A record.")]) -> None:
    """Print each seed of a record and the digest of its trajectory."""
    from neol.run.record_file import read_record

    for info in read_record(record).seeds:
        print(info.seed, info.digest)


@app.command(
    epilog=examples(
        "neol manifest results/first/demo",
        "neol manifest results/first/paper --tasks cartpole",
    )
)
def manifest(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="The folder of one budget's records.")
    ],
    tasks: Annotated[
        str,
        typer.Option(help="Those of its tasks whose records are all there, like cartpole,hopper."),
    ] = "",
) -> None:
    """Write FOLDER/manifest.json: its records and their digests."""
    from neol.study.verification.manifest import NAME, write_manifest

    written = write_manifest(folder, tasks)
    print(f"{folder / NAME}: {len(written.records)} records")


@app.command(
    epilog=examples(
        "neol verify results",
        "neol verify results/first/demo --replay 5 --generations 3",
        "neol verify a.parquet --replay 1 --generations 60 --replay-champions 1",
    )
)
def verify(
    paths: Annotated[
        list[Path], typer.Argument(metavar="PATH", help="Records, or folders of records.")
    ],
    replay: Annotated[int, typer.Option(min=0, help="Runs to repeat, drawn at random.")] = 0,
    generations: Annotated[
        int,
        typer.Option(
            min=1,
            help="Generations to repeat of each run; if that reaches its last, also digest and "
            "champion.",
        ),
    ] = 3,
    replay_champions: Annotated[
        int, typer.Option(min=0, help="Champions to repeat the held-out episodes of.")
    ] = 0,
    seed: Annotated[
        int | None,
        typer.Option(min=0, help="Seed of the draw; without it one is chosen and printed."),
    ] = None,
) -> None:
    """Check records by their digests, rows and manifest; replay runs."""
    from neol.cli.progress import Display
    from neol.study.verification.check import Verification

    verification = Verification(paths)
    findings: list[Problem] = []
    runs: set[Run] = set()
    try:
        with Display() as display:
            for number, checked in enumerate(verification.check(), 1):
                findings += checked.findings
                runs |= {(checked.path, each) for each in checked.seeds}
                display.show(f"record {number} of {len(verification.records)}")
            findings += verification.manifest_findings()
    finally:
        for finding in findings:
            print(finding, flush=True)
    records = _count(len(verification.records), "record")
    summary = [f"{records} of {_count(len(runs), 'run')} checked", *verification.notes()]
    if replay or replay_champions:
        seed = secrets.randbelow(2**32) if seed is None else seed
        summary.append(_repeat(runs, replay, generations, replay_champions, seed, findings))
    outcome = _count(len(findings), "finding") if findings else "all well"
    print(f"{', '.join(summary)}: {outcome}")
    if findings:
        raise typer.Exit(DISAGREES)


def _repeat(
    runs: "Iterable[Run]",
    replay: int,
    generations: int,
    champions: int,
    seed: int,
    findings: "list[Problem]",
) -> str:
    """Repeat what is drawn of the runs and compare; what was repeated, and how to do it again."""
    from neol.base.errors import UserError
    from neol.cli.progress import Display
    from neol.study.verification import replays
    from neol.study.verification.check import Problem

    runs = list(runs)
    drawn = [(run, False) for run in replays.draw(runs, replay, seed)]
    drawn += [(run, True) for run in replays.draw(runs, champions, seed + 1)]
    done = []
    for number, (run, champion) in enumerate(drawn, 1):
        try:
            with Display() as display:
                display.show(f"replay {number} of {len(drawn)}")
                done.append(
                    replays.replay_champion(run) if champion else replays.replay(run, generations)
                )
            problem = done[-1].problem
        except UserError as error:
            problem = Problem(run[0], f"cannot be repeated: {error}", run[1])
        if problem:
            print(problem, flush=True)
            findings.append(problem)
    whole = [each.generations for each in done if each.generations]
    parts = []
    if replay:
        parts.append(f"{_count(len(whole), 'run')} repeated, {_count(sum(whole), 'generation')}")
    if champions:
        played = len(done) - len(whole)
        parts.append(f"{_count(played, 'champion')} played again")
    return f"{', '.join(parts)} (--seed {seed})"


def _count(number: int, one: str) -> str:
    return f"{number:,} {one}{'s' * (number != 1)}"
