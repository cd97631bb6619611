"""A policy as an ONNX graph from raw observation to joint targets, normalization included.

The graph is written node by node. A tracing exporter would give the same dozen nodes, but with source paths in their
metadata, seconds of start-up and one more package.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from torch import Tensor, nn

from camp import __version__
from camp.algo.models import GaussianActor
from camp.common.errors import CampError
from camp.robots.quadruped import NUM_JOINTS

if TYPE_CHECKING:
    import onnx

# Old enough for the runtimes found on robots; every operator in use has been unchanged since.
OPSET = 17
IR_VERSION = 8


class ExportError(CampError):
    """A policy cannot be written as ONNX, or the package for it is missing."""


def require_packages() -> None:
    """Raises ExportError where onnx or onnxruntime is not installed."""
    missing = [name for name in ("onnx", "onnxruntime") if find_spec(name) is None]
    if missing:
        raise ExportError(
            f"package {missing[0]}: not installed; install camp's extra `export`: "
            "pip install -e '.[export]' -c constraints.txt"
        )


def policy_graph(
    actor: GaussianActor, default_pose: Tensor, action_scale: float, metadata: Mapping[str, Any]
) -> onnx.ModelProto:
    """``joint_target = default_pose + action_scale * actor(obs)`` as an ONNX model.

    obs: (N, O) float32, SI units; joint_target: (N, A) float32, rad; default_pose: (A,) rad. N is free. ``metadata``
    goes into ``metadata_props``, each value as JSON. Raises ExportError where the actor holds a layer of another kind
    than Linear and ELU.
    """
    require_packages()
    graph = _Graph()
    graph.add_actor(actor)
    graph.add("Mul", "scaled", action_scale=torch.tensor(action_scale))
    graph.add("Add", "joint_target", default_pose=default_pose)
    return graph.model(("N", len(actor.normalizer.mean)), ("N", len(default_pose)), metadata)


def one_skill_graph(actor: GaussianActor, skill: Tensor, metadata: Mapping[str, Any]) -> onnx.ModelProto:
    """``action = actor([obs, skill])`` as an ONNX model: the policy under one skill, for controllers that know none.

    obs: (1, O - K) float32, SI units, without the skill's entries, which come last; skill: (K,) what the policy
    observes of it; the answer: (1, A) float32, in action scales. Raises ExportError as `policy_graph`.
    """
    require_packages()
    graph = _Graph()
    graph.add("Concat", "with_skill", {"axis": 1}, skill=skill[None])
    graph.add_actor(actor)
    return graph.model((1, len(actor.normalizer.mean) - len(skill)), (1, NUM_JOINTS), metadata)


def largest_difference(model: onnx.ModelProto, reference: nn.Module, observation: Tensor) -> float:
    """Largest difference in rad between onnxruntime's answer and ``reference``'s to ``observation`` (N, O)."""
    require_packages()
    import onnxruntime

    session = onnxruntime.InferenceSession(model.SerializeToString(), providers=["CPUExecutionProvider"])
    (answer,) = session.run(None, {"obs": observation.numpy(force=True)})
    with torch.no_grad():
        expected = reference(observation).numpy(force=True)
    return float(np.abs(np.asarray(answer) - expected).max())


class _Graph:
    """A chain of nodes from `obs`, each fed by the one before it and by constants of its own."""

    def __init__(self) -> None:
        self.nodes: list[onnx.NodeProto] = []
        self.constants: list[onnx.TensorProto] = []
        self._end = "obs"

    def add_actor(self, actor: GaussianActor) -> None:
        """The normalizer and the layers. Raises ExportError for a layer of another kind than Linear and ELU."""
        normalizer = actor.normalizer
        self.add("Sub", "centred", mean=normalizer.mean)
        self.add("Div", "standardized", std=normalizer.std)
        self.add("Clip", "clipped", lower=torch.tensor(-normalizer.clip), upper=torch.tensor(normalizer.clip))
        for i, layer in enumerate(actor.network):
            if isinstance(layer, nn.Linear):
                self.add("Gemm", f"layer_{i}", {"transB": 1}, weight=layer.weight, bias=layer.bias)
            elif isinstance(layer, nn.ELU):
                self.add("Elu", f"layer_{i}", {"alpha": layer.alpha})
            else:
                raise ExportError(f"actor layer {i} is a {type(layer).__name__}: only Linear and ELU can be exported")

    def add(self, operator: str, output: str, attributes: dict[str, Any] | None = None, **constants: Tensor) -> None:
        from onnx import helper, numpy_helper

        inputs = {name: f"{output}/{name}" for name in constants}
        self.constants += [
            numpy_helper.from_array(value.detach().to("cpu", torch.float32).numpy(), inputs[name])
            for name, value in constants.items()
        ]
        chain = [self._end, *inputs.values()]
        self.nodes.append(helper.make_node(operator, chain, [output], name=output, **(attributes or {})))
        self._end = output

    def model(
        self, observed: tuple[int | str, int], answered: tuple[int | str, int], metadata: Mapping[str, Any]
    ) -> onnx.ModelProto:
        """The whole model from `obs` to the last node's output, checked; shapes of both."""
        import onnx
        from onnx import TensorProto, helper

        model = helper.make_model(
            helper.make_graph(
                self.nodes,
                "policy",
                [helper.make_tensor_value_info("obs", TensorProto.FLOAT, observed)],
                [helper.make_tensor_value_info(self._end, TensorProto.FLOAT, answered)],
                self.constants,
            ),
            opset_imports=[helper.make_opsetid("", OPSET)],
            ir_version=IR_VERSION,
            producer_name="camp",
            producer_version=__version__,
        )
        helper.set_model_props(model, {key: json.dumps(value) for key, value in metadata.items()})
        onnx.checker.check_model(model, full_check=True)
        return model
