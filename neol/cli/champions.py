"""Champions after their runs: replay, film, draw, compare and export them."""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from neol.cli.application import DISAGREES, app, complain, examples
from neol.errors import UserError
from neol.rules import find_rule

if TYPE_CHECKING:
    from neol.champions.player import Player

PIPED_WIDTH = 10_000
"""Characters; no line is broken for a reader who is no terminal."""

RecordPath = Annotated[Path, typer.Argument(metavar="RECORD", help="A record.")]
Seed = Annotated[
    int | None, typer.Option(min=0, help="Whose champion; without it that of the first seed.")
]


@app.command(
    epilog=examples(
        "neol replay a.parquet",
        "neol replay a.parquet --seed 3 --episodes 100",
        "neol replay a.parquet --first 7 --episodes 1 --gif champion.gif",
    )
)
def replay(
    record: RecordPath,
    seed: Seed = None,
    episodes: Annotated[int, typer.Option(min=1, help="How many.")] = 5,
    first: Annotated[int, typer.Option(min=0, help="Number of the first one, from 0.")] = 0,
    gif: Annotated[Path | None, typer.Option(help="Film the first one into this file.")] = None,
    human: Annotated[bool, typer.Option("--human", help="Watch them in a window.")] = False,
) -> None:
    """Play a champion's held-out episodes again, compare with the record, film one."""
    from neol.champions.again import play_again
    from neol.champions.film import need_display
    from neol.champions.player import load_champion

    if gif:
        _check_output(gif)
        if gif.suffix.lower() != ".gif":
            raise UserError(f"{gif}: films are GIFs; end its name in .gif")
    player = load_champion(record, seed)
    _check_playable(record, player, first)
    if human:
        need_display()
    there = len(player.held_out_seeds)
    chosen = range(first, min(first + episodes, there))
    print(
        f"{record}: champion of seed {player.spec.seed}, {player.spec.task.environment}, "
        f"{len(chosen)} of its {there} held-out episodes"
    )
    print(f"{'episode':>7}  {'steps':>6}  {'recorded return':>22}  {'replayed':>22}")
    differing = []
    for each in play_again(player, chosen, gif=gif, human=human):
        print(f"{each.episode:>7}  {each.steps:>6}  {each.recorded!r:>22}  {each.replayed!r:>22}")
        if not each.agrees:
            differing.append(str(each.episode))
    if gif:
        print(f"{gif}: episode {first} filmed")
    if differing:
        complain(
            f"{record}: does not agree in episode {', '.join(differing)} of seed "
            f"{player.spec.seed}; neol verify RECORD --replay-champions 1 says why"
        )
        raise typer.Exit(DISAGREES)


@app.command(
    epilog=examples(
        "neol show a.parquet --output champion.pdf",
        "neol show a.parquet --seed 3 --plasticity --episode 7 --output learning.png",
    )
)
def show(
    record: RecordPath,
    seed: Seed = None,
    plasticity: Annotated[
        bool, typer.Option("--plasticity", help="How its weights change within an episode.")
    ] = False,
    episode: Annotated[int, typer.Option(min=0, help="Which held-out one, from 0.")] = 0,
    output: Annotated[Path, typer.Option(help="A .png, .pdf or .svg.")] = Path("champion.png"),
) -> None:
    """Draw a champion's network, or how it learns in an episode."""
    from neol.analysis.style import picture_kind, write_picture
    from neol.champions.drawing import network_figure, plasticity_figure
    from neol.champions.player import load_champion

    picture_kind(output)
    _check_output(output)
    player = load_champion(record, seed)
    if plasticity:
        _check_playable(record, player, episode)
        figure = plasticity_figure(player, player.play(player.held_out_seeds[episode]))
    else:
        figure = network_figure(player)
    write_picture(figure, output)
    print(f"{output}: champion of seed {player.spec.seed}")


@app.command(
    epilog=examples(
        "neol compare a.parquet b.parquet",
        "neol compare results/demo/cartpole/bcm/p050_lr0.25 results/demo/cartpole/neat/p050 \\",
        "    --output curves.png",
    )
)
def compare(
    records: Annotated[
        list[Path], typer.Argument(metavar="RECORD", help="Records, or folders of one cell's.")
    ],
    output: Annotated[
        Path | None, typer.Option(help="Learning curves: a .png, .pdf or .svg.")
    ] = None,
) -> None:
    """Print records side by side: configurations and results."""
    from rich.console import Console
    from rich.table import Table

    from neol.analysis.comparison import differences, learning_curves, outcomes, read_compared
    from neol.analysis.style import picture_kind, write_picture

    if output:
        picture_kind(output)
        _check_output(output)
    compared = read_compared(records)
    table = Table("", *(each.letter for each in compared), box=None, pad_edge=False)
    for name, values in (differences(compared) | outcomes(compared)).items():
        table.add_row(name, *values)
    for each in compared:
        print(f"{each.letter}  {each.path}")
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = PIPED_WIDTH
    console.print(table)
    print("Means over runs; of several, with their 95% intervals.")
    if output:
        write_picture(learning_curves(compared), output)
        print(f"{output}: learning curves")


@app.command(
    epilog=examples(
        "neol export a.parquet --format python --output champion.py",
        "neol export a.parquet --seed 3 --format json --output champion.json",
    )
)
def export(
    record: RecordPath,
    kind: Annotated[
        Literal["json", "onnx", "python"], typer.Option("--format", help="onnx needs its package.")
    ],
    output: Annotated[Path, typer.Option(help="The file.")],
    seed: Seed = None,
) -> None:
    """Write a champion's network, with fixed weights, for use elsewhere."""
    from neol.champions.export import to_json, to_python
    from neol.champions.onnx_export import to_onnx
    from neol.champions.player import load_champion
    from neol.files import write_atomically

    _check_output(output)
    write = {"json": to_json, "onnx": to_onnx, "python": to_python}[kind]
    player = load_champion(record, seed)
    write_atomically(output, write(player))
    print(f"{output}: champion of seed {player.spec.seed}, {player.spec.task.environment}")


def _check_output(output: Path) -> None:
    """Refuse before the work what could not be written after it; missing folders are made then."""
    if output.is_dir():
        raise UserError(f"{output}: is a folder; name a file in it")
    folder = next(each for each in output.absolute().parents if each.exists())
    if not (folder.is_dir() and os.access(folder, os.W_OK | os.X_OK)):
        raise UserError(f"{output}: {folder} is no folder to write in; choose another place")


def _check_playable(record: Path, player: "Player", episode: int) -> None:
    """Refuse before the first line an episode that is not there, or whose rule is not."""
    count = len(player.recorded_returns)
    if episode >= count:
        raise UserError(f"{record}: has no held-out episode {episode}; they are 0 to {count - 1}")
    if player.spec.plasticity.learns:
        try:
            find_rule(player.spec.plasticity.rule)
        except UserError as error:
            raise UserError(f"{record}: {error}") from None
