"""Whether records are what they say: their manifest, their verification, replays of their runs."""

import secrets
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from neol.cli.application import DISAGREES, app, examples

if TYPE_CHECKING:
    from neol.verify import Finding
    from neol.verify_replay import Run


@app.command(epilog=examples("neol manifest results/demo"))
def manifest(folder: Annotated[Path, typer.Argument(help="Of one budget's records.")]) -> None:
    """Write FOLDER/manifest.json anew: the records below it, their digests, what made them."""
    from neol.manifest import NAME, write_manifest

    written = write_manifest(folder)
    print(f"{folder / NAME}: {len(written.records)} records")


@app.command(
    epilog=examples(
        "neol verify results",
        "neol verify results/demo --replay 5 --generations 3",
        "neol verify a.parquet --replay 1 --generations 60 --replay-champions 1",
    )
)
def verify(
    paths: Annotated[list[Path], typer.Argument(help="Records, or folders of records.")],
    replay: Annotated[int, typer.Option(min=0, help="Runs to repeat, drawn at random.")] = 0,
    generations: Annotated[
        int, typer.Option(min=1, help="Generations to repeat of each; with the last, all of it.")
    ] = 3,
    replay_champions: Annotated[
        int, typer.Option(min=0, help="Champions to repeat the held-out episodes of.")
    ] = 0,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Of the draw; without it, a new one is printed.")
    ] = None,
) -> None:
    """Check records: schema, digests, rows, place, manifest; and repeat runs of them."""
    from neol.progress import Display
    from neol.verify import Verification

    checks = [Verification(path) for path in paths]
    records = sum(len(check.records) for check in checks)
    findings: list[Finding] = []
    runs: set[Run] = set()
    with Display() as display:
        for check in checks:
            for number, checked in enumerate(check.check(), 1):
                findings += checked.findings
                runs |= {(checked.path, each) for each in checked.seeds}
                display.show(f"{check.path}: record {number} of {len(check.records)}")
            findings += check.manifest_findings()
    summary = f"{_count(records, 'record')} of {_count(len(runs), 'run')} checked"
    if replay or replay_champions:
        seed = secrets.randbelow(2**32) if seed is None else seed
        findings += _repeat(runs, replay, generations, replay_champions, seed)
        summary += f", {_repeated(len(runs), replay, generations, replay_champions, seed)}"
    for finding in findings:
        print(finding)
    print(f"{summary}: {_count(len(findings), 'finding') if findings else 'all well'}")
    if findings:
        raise typer.Exit(DISAGREES)


def _repeat(
    runs: "Iterable[Run]", replays: int, generations: int, champions: int, seed: int
) -> "Iterator[Finding]":
    """Repeat what is drawn of the runs and compare."""
    from neol import verify_replay
    from neol.progress import Display

    drawn = verify_replay.draw(runs, replays, seed)
    players = verify_replay.draw(runs, champions, seed)
    done = []
    with Display() as display:
        for run in drawn:
            done.append(verify_replay.replay(run, generations))
            display.show(f"replay {len(done)} of {len(drawn) + len(players)}")
        for run in players:
            done.append(verify_replay.replay_champion(run))
            display.show(f"replay {len(done)} of {len(drawn) + len(players)}")
    return verify_replay.findings(done)


def _repeated(runs: int, replays: int, generations: int, champions: int, seed: int) -> str:
    """What was repeated, and how to repeat the same again."""
    parts = []
    if replays:
        drawn = _count(min(runs, replays), "run")
        parts.append(f"{drawn} repeated for {_count(generations, 'generation')}")
    if champions:
        drawn = _count(min(runs, champions), "champion's episodes", "champions' episodes")
        parts.append(f"{drawn} repeated")
    return f"{' and '.join(parts)} (--seed {seed})"


def _count(number: int, one: str, several: str = "") -> str:
    return f"{number:,} {one if number == 1 else several or f'{one}s'}"
