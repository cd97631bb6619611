"""Losses and rewards of CAMP as pure functions of tensors; the paper's equation stands beside each.

Shapes: B batch, T time, N environments, A actions, Z embedding; leading dimensions broadcast.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor
from torch.nn import functional

LOG_SQRT_2PI = 0.5 * math.log(2.0 * math.pi)


def lsgan_loss(expert_logit: Tensor, policy_logit: Tensor) -> Tensor:
    """E[(D(expert) - 1)^2] + E[(D(policy) + 1)^2], first two terms of eq. (3); logits (B,), returns ()."""
    return (expert_logit - 1.0).square().mean() + (policy_logit + 1.0).square().mean()


def gradient_penalty(output: Tensor, inputs: Tensor, generator: torch.Generator | None = None) -> Tensor:
    """E ||d output / d inputs||^2 (squared Frobenius norm), differentiable; third term of eq. (3), eq. (8).

    The paper prints nabla_theta in eq. (3), but a penalty on parameter gradients would shrink the training
    signal itself; AMP's zero-centred penalty (and the paper's own eq. (8)) is on the INPUT gradient,
    nabla_x.

    A scalar output ((B,) or (B, 1)) is exact. For a vector output (B, Z) the Jacobian J costs Z backward
    passes, so one random projection v with E[v v^T] = I estimates it without bias: E ||J^T v||^2 = ||J||_F^2
    (Hutchinson). Signs +-1 are used for v because they have the least variance, and none at all where J's
    rows are orthogonal.

    Arguments: output (B,) or (B, Z) computed from inputs (B, ...), a tensor that requires a gradient;
    generator on the output's device, required for Z > 1. Raises ValueError without it.
    """
    if output.dim() == 1 or output.shape[-1] == 1:
        direction = torch.ones_like(output)
    elif generator is None:
        raise ValueError("gradient_penalty: a vector output needs a generator for its random projection")
    else:
        signs = torch.randint(0, 2, output.shape, generator=generator, device=output.device)
        direction = (2 * signs - 1).to(output.dtype)
    (gradient,) = torch.autograd.grad(output, inputs, grad_outputs=direction, create_graph=True)
    return gradient.flatten(1).square().sum(dim=1).mean()


def style_reward(logit: Tensor) -> Tensor:
    """max(0, 1 - 0.25 (D - 1)^2), eq. (4): 1 where D sees the expert, 0 at D <= -1 and D >= 3."""
    return (1.0 - 0.25 * (logit - 1.0).square()).clamp(min=0.0)


def skill_reward(predicted: Tensor, target: Tensor) -> Tensor:
    """cos(z', z), eq. (6): (..., Z) -> (...) in [-1, 1]; 0 where a vector vanishes."""
    return functional.cosine_similarity(predicted, target, dim=-1, eps=1e-8).clamp(-1.0, 1.0)


def skill_regression_loss(predicted: Tensor, target: Tensor) -> Tensor:
    """E ||z_hat - z||^2, eq. (7); (B, Z) each. No gradient to the target: the style prior learns it."""
    return (predicted - target.detach()).square().sum(dim=-1).mean()


def gae(
    reward: Tensor,
    value: Tensor,
    next_value: Tensor,
    terminated: Tensor,
    truncated: Tensor,
    gamma: float,
    gae_lambda: float,
) -> tuple[Tensor, Tensor]:
    """Generalized advantage estimation (Schulman et al. 2016); all (T, N), returns (advantage, return).

    A terminated step has no future: nothing is bootstrapped. A truncated one has a future that was not
    simulated: `next_value` (of the observation before reset) stands for it. Either way the next row belongs
    to another episode, so the trace is cut.
    """
    same_episode = (~(terminated | truncated)).to(reward.dtype)
    # Filled, not multiplied by zero: an episode that ended because it diverged may have no finite value.
    future = gamma * next_value.masked_fill(terminated, 0.0)
    error = reward + future - value  # (T, N) one-step TD error
    decay = gamma * gae_lambda * same_episode
    advantage = torch.empty_like(error)
    running = torch.zeros_like(error[0])
    for t in range(reward.shape[0] - 1, -1, -1):
        running = error[t] + decay[t] * running
        advantage[t] = running
    return advantage, advantage + value


def clipped_surrogate_loss(log_prob: Tensor, old_log_prob: Tensor, advantage: Tensor, clip: float) -> Tensor:
    """-E[min(r A, clip(r, 1 - c, 1 + c) A)] with r the probability ratio (Schulman et al. 2017, eq. 7)."""
    ratio = (log_prob - old_log_prob).exp()
    clipped = ratio.clamp(1.0 - clip, 1.0 + clip)
    return -torch.min(ratio * advantage, clipped * advantage).mean()


def clipped_value_loss(value: Tensor, old_value: Tensor, return_: Tensor, clip: float) -> Tensor:
    """E[max((V - R)^2, (V_clipped - R)^2)] with V within `clip` of the old value; clip 0: unclipped."""
    error = (value - return_).square()
    if clip == 0.0:
        return error.mean()
    bounded = old_value + (value - old_value).clamp(-clip, clip)
    return torch.max(error, (bounded - return_).square()).mean()


def symmetry_loss(mean: Tensor, mirrored: Tensor, std: Tensor) -> Tensor:
    """E of half the squared difference, in units of the std (A,), between what the policy answers (B, A) and its mirror
    image (B, A): its answer to the mirrored observation, mirrored back. Returns ().

    The KL divergence in nats of two Gaussians with this std. Yu et al. (2018) compare the means in their own unit,
    which weighs less the smaller the exploration becomes.
    """
    return (0.5 * ((mean - mirrored) / std).square()).sum(dim=-1).mean()


def gaussian_log_prob(action: Tensor, mean: Tensor, std: Tensor) -> Tensor:
    """Log density of a diagonal Gaussian; (..., A) -> (...)."""
    return -(0.5 * ((action - mean) / std).square() + std.log() + LOG_SQRT_2PI).sum(dim=-1)


def gaussian_entropy(std: Tensor) -> Tensor:
    """Entropy in nats of a diagonal Gaussian; (..., A) -> (...)."""
    return (std.log() + LOG_SQRT_2PI + 0.5).sum(dim=-1)


def gaussian_kl(old_mean: Tensor, old_std: Tensor, mean: Tensor, std: Tensor) -> Tensor:
    """KL(old || new) in nats between diagonal Gaussians; (..., A) -> (...)."""
    spread = (old_std.square() + (old_mean - mean).square()) / (2.0 * std.square())
    return (std.log() - old_std.log() + spread - 0.5).sum(dim=-1)
