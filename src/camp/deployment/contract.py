"""The contract inside a policy that `camp.export` wrote."""

from __future__ import annotations

from camp.common.errors import CampError
from camp.deployment.metadata import read_metadata
from camp.evaluation.contract import Contract
from camp.evaluation.policies import OnnxAnswer, contract_of_metadata


def contract_inside(answer: OnnxAnswer) -> Contract:
    """The contract of a policy that `camp.export` wrote. Raises CampError for another file."""
    if "joint_names" not in answer.metadata:
        raise CampError(f"policy {answer.path}: holds no metadata of camp.export; give contract=<file>")
    try:
        metadata = read_metadata(answer.metadata)
        return contract_of_metadata(answer.path.stem, metadata)
    except (CampError, KeyError) as error:
        raise CampError(f"policy {answer.path}: {error}; export it again, or give contract=<file>") from error
