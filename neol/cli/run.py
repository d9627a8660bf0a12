"""`neol run`: one configuration, one or several seeds, one record."""

import contextlib
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from neol.base.ending import complain
from neol.base.errors import INTERRUPTED, TERMINATED, UserError
from neol.cli.application import (
    Overrides,
    ReadingOption,
    app,
    complete_budget,
    examples,
    one_reading,
)
from neol.network.rules import RULES, method_names
from neol.spec.types import LARGEST_SEED

if TYPE_CHECKING:
    from neol.run.record import Record

MAX_SEEDS = 10_000


def _methods(incomplete: str) -> list[str]:
    return [name for name in method_names() if name.startswith(incomplete)]


@app.command(
    epilog=examples(
        "neol run --task cartpole --method oja --population 50 --learning-rate 0.0025 \\",
        "    --generations 10 --seed 0-4 --output a.parquet",
        "neol run --task lunar_lander --method neat --population 50 --generations 5 \\",
        "    --workers 2 --output b.parquet",
        "neol run --task gym:Acrobot-v1 --method bcm --population 8 --learning-rate 0.25 \\",
        "    --generations 3 --set evaluation.held_out_episodes=5 --output c.parquet",
    )
)
def run(
    task: Annotated[
        str,
        typer.Option(
            help="Task: cartpole, lunar_lander, hopper, bipedal_walker(_hardcore) or gym:ID."
        ),
    ],
    method: Annotated[
        str,
        typer.Option(
            help="Method: neat, neat_wo (NEAT without weight mutation), "
            f"{', '.join(RULES)}, or RULE_mutated (a rule with weight mutation).",
            autocompletion=_methods,
        ),
    ],
    population: Annotated[int, typer.Option(help="Population size (P), 2 to 100000.")],
    generations: Annotated[int, typer.Option(help="Number of generations (G).")],
    output: Annotated[Path, typer.Option(help="Record to write, a new .parquet file.")],
    learning_rate: Annotated[
        float | None, typer.Option(help="Learning rate (eta); only for plasticity rules.")
    ] = None,
    seed: Annotated[str, typer.Option(help="Seeds of the runs: 3, 0-4 or 0,3,7.")] = "0",
    episodes: Annotated[int | None, typer.Option(help="Episodes per evaluation (N).")] = None,
    max_steps: Annotated[int | None, typer.Option(help="Step limit of an episode (T_max).")] = None,
    reward_scale: Annotated[float | None, typer.Option(help="Reward scale (beta).")] = None,
    weight_mutation: Annotated[
        str | None, typer.Option(help="Weight mutation (WM_MODE): off, config or a probability.")
    ] = None,
    write_back: Annotated[
        bool | None, typer.Option("--write-back/--no-write-back", help="Inherit learned weights.")
    ] = None,
    budget: Annotated[
        str | None,
        typer.Option(
            help="Budget whose constants apply (held-out episodes, step limits); its grid is not "
            "used; default: paper.",
            autocompletion=complete_budget,
        ),
    ] = None,
    reading: ReadingOption = None,
    overrides: Overrides = None,
    engine: Annotated[
        Literal["auto", "fast", "reference"],
        typer.Option(help="Rollout engine; does not change results."),
    ] = "auto",
    workers: Annotated[
        int, typer.Option(min=1, help="Parallel workers; does not change results.")
    ] = 1,
    checkpoint_every: Annotated[
        int, typer.Option(min=1, help="Generations between checkpoints.")
    ] = 10,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue an interrupted run, if there is one.")
    ] = False,
    keep_partial: Annotated[
        bool, typer.Option("--keep-partial", help="Keep OUTPUT.partial with a record per seed.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print errors only.")] = False,
) -> None:
    """Run a configuration with one or several seeds; write a record."""
    seeds = parse_seeds(seed)
    if output.suffix != ".parquet":
        raise UserError(f"{output}: records are Parquet files; end its name in .parquet")
    constants = {
        "--max-steps": (("tasks", task, "max_steps"), max_steps),
        "--episodes": (("evaluation", "episodes"), episodes),
        "--reward-scale": (("plasticity", "reward_scale"), reward_scale),
        "--weight-mutation": (("methods", method, "weight_mutation"), weight_mutation),
        "--write-back": (
            ("plasticity", "write_back"),
            None if write_back is None else str(write_back).lower(),
        ),
    }
    options = [
        (option, loc, str(value)) for option, (loc, value) in constants.items() if value is not None
    ]

    from neol.spec.configuration import PAPER_BUDGET, load_configuration

    budget_name, overrides = budget or PAPER_BUDGET, overrides or []
    # Before the options: --max-steps would add an unknown task to the configuration.
    label = one_reading(reading)
    load_configuration(budget_name, overrides, reading=label).check_names(task, method)
    configuration = load_configuration(budget_name, overrides, options, label)
    spec = configuration.run_spec(
        task=task,
        method=method,
        population=population,
        learning_rate=learning_rate,
        generations=generations,
        seed=seeds[0],
    )
    finished = output.exists()

    from neol.cli.progress import Progress
    from neol.run.runner import run_block

    with _says_how_to_go_on(output), contextlib.ExitStack() as stack:
        progress = None if quiet else stack.enter_context(Progress(seeds, generations))
        record = run_block(
            spec,
            seeds,
            output,
            engine=engine,
            workers=workers,
            checkpoint_every=checkpoint_every,
            resume=resume,
            keep_partial=keep_partial,
            budget=None if budget is None else configuration.budget.name,
            reading=configuration.reading,
            on_generation=progress,
        )
    if not quiet:
        _summarise(output, record, finished)


def parse_seeds(text: str) -> list[int]:
    """Parse seeds like "3", "0-4" or "0,3,7-9" and sort them. Raises UserError."""
    seeds: list[int] = []
    for part in text.split(","):
        match = re.fullmatch(r"(\d+)(?:-(\d+))?", part.strip())
        if match is None:
            raise UserError(f"--seed {text}: give integers from 0 as 3, 0-4 or 0,3,7")
        first, last = _seed(match[1]), _seed(match[2] or match[1])
        if not 0 <= last - first < MAX_SEEDS:
            raise UserError(f"--seed {text}: {part} is not a range of 1 to {MAX_SEEDS} seeds")
        seeds.extend(range(first, last + 1))
    if len(set(seeds)) < len(seeds):
        raise UserError(f"--seed {text}: names a seed twice")
    return sorted(seeds)


def _seed(digits: str) -> int:
    if len(digits) > len(str(LARGEST_SEED)) or int(digits) > LARGEST_SEED:
        raise UserError(f"--seed {digits}: the largest seed is {LARGEST_SEED}")
    return int(digits)


@contextlib.contextmanager
def _says_how_to_go_on(output: Path) -> Iterator[None]:
    """Make Ctrl-C, SIGTERM and the like end the run in one line that says how to go on."""
    from neol.base.interruption import Terminated, interruptible
    from neol.run.workspace import partial_folder

    try:
        with interruptible():
            yield
    except KeyboardInterrupt as stop:
        if output.exists():  # it was complete; only the cleanup was interrupted
            raise typer.Exit from None
        kept = partial_folder(output)
        way_on = (
            f"progress is kept in {kept}; run the same command with --resume to continue"
            if kept.exists()
            else "no generation was completed, so nothing is kept"
        )
        terminated = isinstance(stop, Terminated)
        complain(f"{TERMINATED if terminated else INTERRUPTED}: {way_on}")
        raise typer.Exit(143 if terminated else 130) from None


def _summarise(output: Path, record: "Record", finished: bool) -> None:
    if finished:
        print(f"{output}: already complete, nothing to do")
    else:
        from neol.rollout import describe

        print(f"{output}: written (engine: {describe(record.spec.task, record.seeds[-1].engine)})")
    for info in record.seeds:
        held_out = info.held_out
        mean = "failed" if held_out.mean is None else f"{held_out.mean:.1f}"
        spread = "" if held_out.sd is None else f" ± {held_out.sd:.1f}"
        print(
            f"seed {info.seed}: best {info.champion.fitness:.1f}, champion in "
            f"{len(held_out.returns)} held-out episodes {mean}{spread}, digest {info.digest}"
        )
