"""The shipped values fit their schema, and values out of range are named with a remedy."""

from __future__ import annotations

import pytest
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

from camp.algo.config import AlgoConfig
from camp.common.bounds import check_numbers
from camp.common.errors import ConfigError
from tests.algo.synthetic import CONF, shipped_config


def test_shipped_config_is_complete_and_valid():
    merged = OmegaConf.merge(OmegaConf.structured(AlgoConfig), OmegaConf.load(CONF))
    assert OmegaConf.missing_keys(merged) == set()
    shipped_config().check()


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("task_weight", float("nan")),
        ("embedding_size", 0),
        ("actor.hidden", []),
        ("actor.initial_std", 5.0),
        ("actor.min_std", 0.0),
        ("critic.hidden", [64, 0]),
        ("ppo.gamma", 1.01),
        ("ppo.gae_lambda", -0.1),
        ("ppo.clip_param", 0.0),
        ("ppo.value_clip_param", -1.0),
        ("ppo.entropy_coef", float("nan")),
        ("ppo.epochs", 0),
        ("ppo.minibatches", 0),
        ("ppo.learning_rate", 0.5),
        ("ppo.min_learning_rate", -1e-5),
        ("ppo.desired_kl", 0.0),
        ("ppo.final_desired_kl", 1.0),
        ("ppo.settle_fraction", 1.5),
        ("ppo.critic_learning_rate", float("inf")),
        ("ppo.max_grad_norm", 0.0),
        ("style.weight", -1.0),
        ("style.learning_rate", 0.0),
        ("style.updates", 0),
        ("style.batch_size", 0),
        ("style.gradient_penalty", -1.0),
        ("style.replay_size", -1),
        ("style.input_noise", -0.1),
        ("style.mismatch_fraction", 1.0),
        ("skill.weight", float("nan")),
        ("skill.gradient_penalty", -0.1),
        ("skill.batch_size", 0),
        ("imitation.epochs", -1),
        ("imitation.batch_size", 0),
        ("imitation.learning_rate", 0.0),
        ("imitation.last_action_noise", -1.0),
    ],
)
def test_out_of_range_names_key_value_and_remedy(key: str, value: object):
    raw = OmegaConf.merge(OmegaConf.structured(AlgoConfig), OmegaConf.load(CONF))
    OmegaConf.update(raw, key, value)
    config = OmegaConf.to_object(raw)
    assert isinstance(config, AlgoConfig)
    with pytest.raises(ConfigError) as error:
        check_numbers("algo", config)
        config.check()
    message = str(error.value)
    assert f"algo.{key} = {value!r}" in message and "\n" not in message
    assert any(word in message for word in ("choose", "list", "set"))


def test_wrong_labels_need_conditioning():
    config = shipped_config()
    config.style.conditional, config.style.mismatch_fraction = False, 0.25
    with pytest.raises(ConfigError, match=r"algo\.style\.mismatch_fraction = 0\.25.*conditional"):
        config.check()


@pytest.mark.parametrize("override", ["ppo.discuont=0.9", "ppo.epochs=many", "style.enabled=maybe"])
def test_unknown_keys_and_wrong_types_fail(override: str):
    with pytest.raises(OmegaConfBaseException):
        OmegaConf.merge(OmegaConf.structured(AlgoConfig), OmegaConf.load(CONF), OmegaConf.from_dotlist([override]))
