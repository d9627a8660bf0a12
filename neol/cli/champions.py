"""Commands for champions: replay, film, draw and export."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from neol.base.ending import complain
from neol.base.errors import UserError
from neol.cli.application import DISAGREES, RecordPath, app, check_output, examples
from neol.network.rules import find_rule

if TYPE_CHECKING:
    from neol.champions.player import Player


SeedOption = Annotated[
    int | None, typer.Option(min=0, help="Seed of the champion's run; default: the first.")
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
    seed: SeedOption = None,
    episodes: Annotated[int, typer.Option(min=1, help="Number of episodes.")] = 5,
    first: Annotated[int, typer.Option(min=0, help="First episode, from 0.")] = 0,
    gif: Annotated[Path | None, typer.Option(help="Film the first episode into this GIF.")] = None,
    human: Annotated[bool, typer.Option("--human", help="Show episodes in a window.")] = False,
) -> None:
    """Replay a champion's held-out episodes and compare their returns."""
    from neol.champions.player import load_champion
    from neol.pictures.film import need_display
    from neol.pictures.replay import play_again

    if gif:
        check_output(gif)
        if gif.suffix.lower() != ".gif":
            raise UserError(f"{gif}: films are GIFs; end its name in .gif")
    player = load_champion(record, seed)
    _check_playable(record, player, first)
    if human:
        need_display()
    count = len(player.held_out_seeds)
    chosen = range(first, min(first + episodes, count))
    print(
        f"{record}: champion of seed {player.spec.seed}, {player.spec.task.environment}, "
        f"{len(chosen)} of its {count} held-out episodes"
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
            f"{record}: the replay differs in episode {', '.join(differing)} of seed "
            f"{player.spec.seed}: edited, or made on a machine that rounds differently"
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
    seed: SeedOption = None,
    plasticity: Annotated[
        bool, typer.Option("--plasticity", help="Draw how weights change within an episode.")
    ] = False,
    episode: Annotated[int, typer.Option(min=0, help="Held-out episode, from 0.")] = 0,
    output: Annotated[Path, typer.Option(help="Picture: .png, .pdf or .svg.")] = Path(
        "champion.png"
    ),
) -> None:
    """Draw a champion's network, or its learning within an episode."""
    from neol.champions.player import load_champion
    from neol.pictures.network import network_figure, plasticity_figure
    from neol.pictures.style import picture_kind, write_picture

    picture_kind(output)
    check_output(output)
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
        "neol export a.parquet --format onnx --output champion.onnx",
        "neol export a.parquet --seed 3 --format json --output champion.json",
    )
)
def export(
    record: RecordPath,
    kind: Annotated[
        Literal["json", "onnx"],
        typer.Option("--format", help="File format; onnx needs that package."),
    ],
    output: Annotated[Path, typer.Option(help="File to write.")],
    seed: SeedOption = None,
) -> None:
    """Write a champion's network, with fixed weights, to a file."""
    from neol.base.files import write_atomically
    from neol.champions.export import to_json
    from neol.champions.onnx_export import to_onnx
    from neol.champions.player import load_champion

    check_output(output)
    write = {"json": to_json, "onnx": to_onnx}[kind]
    player = load_champion(record, seed)
    write_atomically(output, write(player))
    print(f"{output}: champion of seed {player.spec.seed}, {player.spec.task.environment}")


def _check_playable(record: Path, player: "Player", episode: int) -> None:
    """Raise UserError, before any output, for a missing episode or an unknown rule."""
    count = len(player.recorded_returns)
    if episode >= count:
        raise UserError(f"{record}: has no held-out episode {episode}; they are 0 to {count - 1}")
    if player.spec.plasticity.learns:
        try:
            find_rule(player.spec.plasticity.rule)
        except UserError as error:
            raise UserError(f"{record}: {error}") from None
