"""Export of champions as ONNX models; needs the package onnx."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from neol.base.errors import UserError
from neol.champions.export import Continuous, Discrete, export
from neol.champions.layout import edges, layers
from neol.champions.player import Floats, Player
from neol.network.forward import Networks

OPSET, IR_VERSION = 17, 8
"""Operator set of 2022, which older runtimes read too."""
_IN_THE_GRAPH = {"action", "nodes", "sum_limit", "activation_scale", "format"}
_OPERATORS = {"tanh": "Tanh", "relu": "Relu", "sigmoid": "Sigmoid", "identity": "Identity"}


def to_onnx(player: Player) -> bytes:
    """Return the network as an ONNX model in float64.

    Input `observation`, float64[batch, I]; outputs `outputs`, float64[batch, O], and `action` in
    the environment's form. A layer is one matrix product, which may add in another order than
    `neol.network.forward.forward`, so outputs may differ in the last bits.
    Raises UserError if the package onnx is not installed.
    """
    try:
        import onnx
        from onnx import helper
    except ModuleNotFoundError:
        raise UserError("--format onnx needs the package onnx: pip install onnx") from None

    network = export(player)
    computation = _Computation()
    _add_layers(computation, player)
    action = _add_action(computation, network.action, len(network.outputs))
    model = helper.make_model(
        computation.graph(len(network.inputs), len(network.outputs), action),
        producer_name="neol",
        ir_version=IR_VERSION,
        opset_imports=[helper.make_opsetid("", OPSET)],
    )
    about = network.model_dump(mode="json", exclude=_IN_THE_GRAPH)
    helper.set_model_props(model, {key: str(value) for key, value in about.items()})
    onnx.checker.check_model(model, full_check=True)
    return bytes(model.SerializeToString(deterministic=True))


@dataclass(slots=True)
class _Computation:
    """Operations on named values, from `observation` to `outputs` and `action`."""

    operations: list[Any] = field(default_factory=list)
    constants: dict[str, npt.NDArray[Any]] = field(default_factory=dict)

    def add(self, operator: str, operands: list[str], result: str, **attributes: Any) -> str:
        """Add an operation and return the name of its result."""
        from onnx import helper

        self.operations.append(helper.make_node(operator, operands, [result], **attributes))
        return result

    def graph(self, inputs: int, outputs: int, action: Any) -> Any:
        """Return the complete graph; `action` is the description of that output."""
        from onnx import TensorProto, helper, numpy_helper

        constants = [numpy_helper.from_array(value, name) for name, value in self.constants.items()]
        observation, output = (
            helper.make_tensor_value_info(name, TensorProto.DOUBLE, ["batch", width])
            for name, width in (("observation", inputs), ("outputs", outputs))
        )
        return helper.make_graph(
            self.operations, "champion", [observation], [output, action], constants
        )


def _add_layers(computation: _Computation, player: Player) -> None:
    """Compute `outputs` from `observation`: one matrix product for each layer."""
    limit = player.network.sum_limit
    computation.constants |= {"low_sum": np.array(-limit), "high_sum": np.array(limit)}
    computation.constants["scale"] = np.array(player.network.activation_scale)
    values = "observation"
    *hidden, last = matrices(player.network)
    for layer, (weights, bias) in enumerate([*hidden, last], 1):
        computation.constants |= {f"weights_{layer}": weights, f"bias_{layer}": bias}
        total = computation.add("MatMul", [values, f"weights_{layer}"], f"product_{layer}")
        total = computation.add("Add", [total, f"bias_{layer}"], f"sum_{layer}")
        total = computation.add("Clip", [total, "low_sum", "high_sum"], f"clipped_{layer}")
        total = computation.add("Mul", [total, "scale"], f"scaled_{layer}")
        if layer > len(hidden):
            computation.add("Tanh", [total], "outputs")
        else:
            operator = _OPERATORS[player.spec.network.hidden_activation]
            active = computation.add(operator, [total], f"activity_{layer}")
            values = computation.add("Concat", [values, active], f"values_{layer}", axis=1)


def _add_action(computation: _Computation, action: Discrete | Continuous, outputs: int) -> Any:
    """Compute `action` from `outputs` and return its description."""
    from onnx import TensorProto, helper

    if isinstance(action, Discrete):
        computation.constants["start"] = np.array(action.start)
        largest = computation.add("ArgMax", ["outputs"], "largest", axis=1, keepdims=0)
        computation.add("Add", [largest, "start"], "action")
        return helper.make_tensor_value_info("action", TensorProto.INT64, ["batch"])
    computation.constants |= {"low": np.array(action.low), "high": np.array(action.high)}
    clipped = computation.add("Max", ["outputs", "low"], "not_below")
    clipped = computation.add("Min", [clipped, "high"], "clipped")
    kind = helper.np_dtype_to_tensor_dtype(np.dtype(action.dtype))
    computation.add("Cast", [clipped], "action", to=kind)
    return helper.make_tensor_value_info("action", kind, ["batch", outputs])


def matrices(network: Networks) -> Iterator[tuple[Floats, Floats]]:
    """Yield each layer's weights, float64[nodes before it, its nodes], and biases; no inputs."""
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
