"""Schema of conf/logger."""

from __future__ import annotations

from dataclasses import dataclass

from omegaconf import MISSING

from camp.common import checks

WANDB_MODES = ("offline", "online", "disabled")


@dataclass
class LoggerConfig:
    """Where metrics go besides the run folder."""

    wandb_mode: str = MISSING  # offline: files only, no network; online: uploaded at once; disabled: no W&B
    wandb_project: str = MISSING
    wandb_tags: list[str] = MISSING  # besides the ones the run gives itself

    def check(self) -> None:
        """Raise ConfigError for a value that cannot work."""
        modes = f"choose one of {', '.join(WANDB_MODES)}"
        checks.require(self.wandb_mode in WANDB_MODES, "logger.wandb_mode", self.wandb_mode, modes)
        plain = bool(self.wandb_project) and not set(self.wandb_project) & set("/\\#?%:")
        remedy = "write a name without any of / \\ # ? % :"
        checks.require(plain, "logger.wandb_project", self.wandb_project, remedy)
