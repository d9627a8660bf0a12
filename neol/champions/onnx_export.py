"""Champions as ONNX, for any runtime of that format. Needs the package onnx."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from neol.champions.export import Discrete, export
from neol.champions.graph import edges, layers
from neol.champions.player import Floats, Player
from neol.errors import UserError
from neol.network import Networks

OPSET, IR_VERSION = 17, 8
"""Of 2022, so that not only the newest runtimes read it."""
_OPERATORS = {"tanh": "Tanh", "relu": "Relu", "sigmoid": "Sigmoid", "identity": "Identity"}


def to_onnx(player: Player) -> bytes:
    """The network as an ONNX model in float64.

    Input `observation`, float64[batch, I]; outputs `outputs`, float64[batch, O], and `action`, as
    the environment takes it. A layer is one matrix product, which may add in another order than
    `neol.network.forward`: outputs may differ in the last bits.
    Raises UserError where the package onnx is not installed.
    """
    try:
        import onnx
        from onnx import TensorProto, helper, numpy_helper
    except ModuleNotFoundError:
        raise UserError("--format onnx needs the package onnx: pip install onnx") from None

    network = export(player)
    inputs, outputs, action = len(network.inputs), len(network.outputs), network.action
    constants = {"low_sum": np.array(-network.sum_limit), "high_sum": np.array(network.sum_limit)}
    nodes = []

    def compute(operator: str, operands: list[str], result: str, **attributes: Any) -> str:
        nodes.append(helper.make_node(operator, operands, [result], **attributes))
        return result

    values = "observation"
    *hidden, last = matrices(player.network)
    for layer, (weights, bias) in enumerate([*hidden, last], 1):
        constants |= {f"weights_{layer}": weights, f"bias_{layer}": bias}
        total = compute("MatMul", [values, f"weights_{layer}"], f"product_{layer}")
        total = compute("Add", [total, f"bias_{layer}"], f"sum_{layer}")
        total = compute("Clip", [total, "low_sum", "high_sum"], f"clipped_{layer}")
        if layer > len(hidden):
            compute("Tanh", [total], "outputs")
        else:
            operator = _OPERATORS[player.spec.network.hidden_activation]
            active = compute(operator, [total], f"activity_{layer}")
            values = compute("Concat", [values, active], f"values_{layer}", axis=1)
    if isinstance(action, Discrete):
        constants["start"] = np.array(action.start)
        largest = compute("ArgMax", ["outputs"], "largest", axis=1, keepdims=0)
        compute("Add", [largest, "start"], "action")
        kind, width = TensorProto.INT64, []
    else:
        constants |= {"low": np.array(action.low), "high": np.array(action.high)}
        clipped = compute("Max", ["outputs", "low"], "not_below")
        clipped = compute("Min", [clipped, "high"], "clipped")
        kind = helper.np_dtype_to_tensor_dtype(np.dtype(action.dtype))
        compute("Cast", [clipped], "action", to=kind)
        width = [outputs]

    def floats(name: str, width: int) -> onnx.ValueInfoProto:
        return helper.make_tensor_value_info(name, TensorProto.DOUBLE, ["batch", width])

    graph = helper.make_graph(
        nodes,
        "champion",
        [floats("observation", inputs)],
        [
            floats("outputs", outputs),
            helper.make_tensor_value_info("action", kind, ["batch", *width]),
        ],
        [numpy_helper.from_array(value, name) for name, value in constants.items()],
    )
    model = helper.make_model(
        graph,
        producer_name="neol",
        ir_version=IR_VERSION,
        opset_imports=[helper.make_opsetid("", OPSET)],
    )
    about = network.model_dump(mode="json", exclude={"action", "nodes", "sum_limit", "format"})
    helper.set_model_props(model, {key: str(value) for key, value in about.items()})
    onnx.checker.check_model(model, full_check=True)
    return bytes(model.SerializeToString(deterministic=True))


def matrices(network: Networks) -> Iterator[tuple[Floats, Floats]]:
    """Weights, float64[all nodes before it, its nodes], and biases of each layer but the inputs."""
    first, *others = layers(network)
    column = {node: place for place, node in enumerate(first)}
    incoming = list(zip(edges(network), network.weight.tolist(), strict=True))
    for layer in others:
        weights = np.zeros((len(column), len(layer)))
        for (source, target), weight in incoming:
            if target in layer:
                weights[column[source], layer.index(target)] = weight
        yield weights, network.bias[np.array(layer) - network.inputs]
        column |= {node: len(column) + place for place, node in enumerate(layer)}
