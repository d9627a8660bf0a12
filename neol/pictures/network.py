"""Pictures of champions: their networks, and changes of their weights within an episode."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure, FigureBase
from matplotlib.lines import Line2D

from neol.base.errors import UserError
from neol.champions.layout import Edge, Graph, graph
from neol.champions.player import Floats, Player, Trace
from neol.pictures.labels import drawn, method_label, task_label
from neol.pictures.style import GREY, WIDTH, drawing
from neol.spec.observations import names

COOL_TO_WARM = LinearSegmentedColormap.from_list(
    "cool to warm", ["#0b3c8c", "#86a9d8", "#dcdcdc", "#f6b878", "#e06c00"]
)
"""Blue to orange, as in Figure 1: distinguishable with colour blindness, and blue prints darker."""
THINNEST, THICKEST = 0.4, 3.2
"""Line widths in points: of a weight near 0 and of the largest weight."""
WITHOUT_THRESHOLD = ("hebb", "oja")
"""Rules that do not use the threshold."""
ROW = 1.25
"""Height in inches of a plot over time."""
APART = 0.11
"""Least distance of names at the right of a plot, as a fraction of its height."""
NAMED = 3
"""Number of weights that are named: those that change most."""

# --- Networks -----------------------------------------------------------------------------------


def draw_network(
    axes: Axes,
    player: Player,
    *,
    weights: Floats | None = None,
    colours: Floats | None = None,
    limit: float | None = None,
    inputs: bool = True,
    outputs: bool = True,
) -> LineCollection:
    """Draw a champion's network on given axes: inputs left, outputs right.

    A line's width grows with the size of its weight; its colour is cool below 0, warm above, and
    deepest at +-limit. `weights` replace the inherited ones; `colours` are another quantity for
    the colour; both are float64[E]. Disabled genes are dotted; hidden nodes without an enabled
    connection are omitted. `inputs` and `outputs` say which names are written. Returns the lines,
    for a colour bar.
    """
    weights = player.network.weight if weights is None else weights
    colours = weights if colours is None else colours
    shown = graph(player)
    limit = limit or _largest(colours)
    lines = LineCollection(
        [[shown.places[source], shown.places[target]] for source, target in shown.enabled],
        array=colours,
        cmap=COOL_TO_WARM,
        norm=Normalize(-limit, limit),
        linewidths=THINNEST + (THICKEST - THINNEST) * np.abs(weights) / _largest(weights),
        capstyle="round",
        zorder=1,
    )
    disabled = LineCollection(
        [[shown.places[source], shown.places[target]] for source, target in shown.disabled],
        colors="0.75",
        linewidths=0.5,
        linestyles=":",
        zorder=0,
    )
    axes.add_collection(lines)
    axes.add_collection(disabled)
    _draw_nodes(axes, player, shown)
    _write_names(axes, player, shown, inputs=inputs, outputs=outputs)
    axes.set_xlim(-0.02, 1.02)
    axes.set_ylim(0, 1)
    axes.set_axis_off()
    return lines


def _draw_nodes(axes: Axes, player: Player, shown: Graph) -> None:
    """Draw nodes as circles; those of hidden nodes are larger and numbered."""
    network = player.network
    hidden = range(network.inputs, network.inputs + len(network.bias) - network.outputs)
    for node, place in shown.places.items():
        size = 44 if node in hidden else 20
        axes.scatter(*place, s=size, facecolor="white", edgecolor="black", linewidth=0.8, zorder=2,
                     clip_on=False)  # fmt: skip
        if node in hidden:
            number = str(node - network.inputs + 1)
            axes.annotate(number, place, ha="center", va="center", fontsize=5)


def _write_names(axes: Axes, player: Player, shown: Graph, *, inputs: bool, outputs: bool) -> None:
    """Write the names of inputs left of them and of outputs right of them, as requested."""
    for node, name in _node_names(player).items():
        is_input = node < player.network.inputs
        if inputs if is_input else outputs:
            axes.annotate(
                name,
                shown.places[node],
                (-6 if is_input else 6, 0),
                textcoords="offset points",
                ha="right" if is_input else "left",
                va="center",
                fontsize=7,
            )


def network_figure(player: Player) -> Figure:
    """Draw a champion's network with names, title and legend."""
    with drawing():
        figure = Figure(figsize=(0.9 * WIDTH, _height(player) + 0.8))
        figure.suptitle(title(player), x=0.01, ha="left")
        axes = figure.add_subplot()
        _colour_bar(figure, draw_network(axes, player), [axes], "Weight")
        largest = _number(_largest(player.network.weight), 2)
        key = [
            Line2D([], [], color=GREY, linewidth=THICKEST, label=f"|weight| {largest}"),
            Line2D([], [], color=GREY, linewidth=THINNEST, label="|weight| near 0"),
        ]
        if graph(player).disabled:
            label = "disabled gene"
            key.append(Line2D([], [], color="0.75", linewidth=0.5, linestyle=":", label=label))
        axes.legend(handles=key, loc="upper center", bbox_to_anchor=(0.5, 0), ncols=len(key))
    return figure


def title(player: Player) -> str:
    """Return a title: task, method, seed and the champion's fitness."""
    spec = player.spec
    held_out = np.array(player.recorded_returns)
    held_out = held_out[np.isfinite(held_out)]
    mean = f", held-out mean {_number(held_out.mean())}" if len(held_out) else ""
    return (
        f"{task_label(spec.task.name)}, {method_label(spec.method)}, seed {spec.seed}: "
        f"fitness {_number(player.genome.fitness)}{mean}"
    )


# --- Plasticity ---------------------------------------------------------------------------------


def plasticity_figure(player: Player, trace: Trace) -> Figure:
    """Draw how weights change within an episode, as in the paper's Figure 1, and what drives it.

    Top: the network at the start, in the middle and at the end, each weight coloured by its change
    since the start, on the scale of the largest weight: what changes little stays pale. Below, over
    the same steps: changes, rewards and, if the rule uses them, thresholds. Raises UserError for a
    champion that does not learn.
    """
    spec = player.spec
    if not spec.plasticity.learns:
        raise UserError(
            f"{method_label(spec.method)} does not learn within an episode; "
            "--plasticity needs a champion of a method that does"
        )
    changes = trace.weights - trace.weights[0]
    plots = [
        _changes,
        _rewards,
        *([] if spec.plasticity.rule in WITHOUT_THRESHOLD else [_thresholds]),
    ]
    heights = [0.85 * _height(player) + 0.3, ROW * len(plots)]
    with drawing():
        figure = Figure(figsize=(1.15 * WIDTH, sum(heights) + 0.6))
        summary = (
            f"An episode of {len(trace)} steps, return {_number(trace.episode_return)}: the "
            f"largest change of a weight is {_two_figures(changes)}, the largest weight "
            f"{_two_figures(trace.weights)}"
        )
        figure.suptitle(f"{title(player)}\n{summary}", x=0.01, ha="left")
        above, below = figure.subfigures(2, squeeze=False, height_ratios=heights)[:, 0]
        panels = above.subplots(1, 3)
        moments = {"Start": 0, "Middle": len(trace) // 2, "End": len(trace)}
        for axes, (name, step) in zip(panels, moments.items(), strict=True):
            lines = draw_network(
                axes,
                player,
                weights=trace.weights[step],
                colours=changes[step],
                limit=_largest(trace.weights),
                inputs=name == "Start",
                outputs=name == "End",
            )
            axes.set_title(f"{name} (step {step})")
        _colour_bar(above, lines, panels, "Change of weight")
        over_time = below.subplots(len(plots), sharex=True)
        for axes, plot in zip(over_time, plots, strict=True):
            plot(axes, player, trace)
        over_time[-1].set_xlabel("Step")
        below.align_ylabels()
    return figure


def _changes(axes: Axes, player: Player, trace: Trace) -> None:
    """Plot the change of each weight, those that change most in black and with their names."""
    changes = trace.weights - trace.weights[0]
    order = np.argsort(np.abs(changes).max(axis=0))
    for edge in order:
        named = edge in order[-NAMED:]
        axes.plot(changes[:, edge], color="black" if named else "0.75", linewidth=1)
    connections = graph(player).enabled
    _name_ends(
        axes,
        len(trace),
        [(changes[-1, edge], _edge_name(player, connections[edge])) for edge in order[-NAMED:]],
    )
    axes.set_ylabel("Change of weight")


def _rewards(axes: Axes, _player: Player, trace: Trace) -> None:
    axes.plot(np.arange(1, len(trace) + 1), trace.rewards, color="black", linewidth=1)
    axes.set_ylabel("Reward")


def _thresholds(axes: Axes, player: Player, trace: Trace) -> None:
    """Plot the threshold of each node: hidden nodes grey, outputs with names."""
    hidden = len(player.network.bias) - player.network.outputs
    axes.plot(trace.thresholds[:, :hidden], color="0.8", linewidth=0.8)
    axes.plot(trace.thresholds[:, hidden:], color="black", linewidth=1)
    known = _node_names(player)
    _name_ends(
        axes,
        len(trace),
        [
            (trace.thresholds[-1, node], known[player.network.inputs + node])
            for node in range(hidden, len(player.network.bias))
        ],
    )
    axes.set_ylabel("Threshold θ")


def _name_ends(axes: Axes, x: float, ends: Iterable[tuple[float, str]]) -> None:
    """Write names beside the ends of lines at x, spread so that they do not overlap."""
    bottom, top = axes.get_ylim()
    axes.set_ylim(bottom, top)
    ends = sorted(ends)
    heights = [(y - bottom) / (top - bottom) for y, _ in ends]
    for above in range(1, len(ends)):
        heights[above] = max(heights[above], heights[above - 1] + APART)
    highest = 1.0
    for place in reversed(range(len(ends))):
        heights[place] = highest = min(heights[place], highest)
        highest -= APART
    for (y, name), height in zip(ends, heights, strict=True):
        axes.annotate(
            name,
            (x, y),
            (1.02, height),
            textcoords="axes fraction",
            va="center",
            fontsize=6.5,
            arrowprops={"arrowstyle": "-", "color": GREY, "linewidth": 0.4},
        )


# --- Names and numbers --------------------------------------------------------------------------


def _node_names(player: Player) -> dict[int, str]:
    """Return the names of inputs and outputs, by node."""
    network = player.network
    inputs, outputs = names(player.spec.task, network.inputs, network.outputs)
    first_output = network.inputs + len(network.bias) - network.outputs
    return dict(enumerate(inputs)) | dict(enumerate(outputs, start=first_output))


def _edge_name(player: Player, edge: Edge) -> str:
    known, inputs = _node_names(player), player.network.inputs
    source, target = (known.get(node, f"hidden {node - inputs + 1}") for node in edge)
    return f"{source} → {target}"


def _height(player: Player) -> float:
    """Return the height in inches of a network with names."""
    return max(1.6, 0.16 * max(player.network.inputs, player.network.outputs))


def _colour_bar(
    figure: FigureBase, lines: LineCollection, axes: Sequence[Axes], label: str
) -> None:
    bar: Any = figure.colorbar(lines, ax=axes, fraction=0.03, pad=0.02, aspect=16, label=label)
    bar.outline.set_visible(False)


def _largest(values: Floats) -> float:
    """Return the largest absolute value; 1 if all are 0."""
    return float(np.abs(values).max(initial=0.0)) or 1.0


def _two_figures(values: Floats) -> str:
    """The largest size among some values, as a picture prints it."""
    return drawn(f"{np.abs(values).max(initial=0.0):.2g}")


def _number(value: float, digits: int = 1) -> str:
    return drawn(f"{value:.{digits}f}")
