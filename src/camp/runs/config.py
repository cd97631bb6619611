"""Schema of conf/logger."""

from __future__ import annotations

from dataclasses import dataclass

from omegaconf import MISSING

from camp.common.errors import ConfigError

WANDB_MODES = ("offline", "online", "disabled")


@dataclass
class LoggerConfig:
    """Where metrics go besides the run folder."""

    wandb_mode: str = MISSING  # offline: files only, no network; online: uploaded at once; disabled: no W&B
    wandb_project: str = MISSING
    wandb_tags: list[str] = MISSING  # besides the ones the run gives itself

    def check(self) -> None:
        """Raise ConfigError for a value that cannot work."""
        if self.wandb_mode not in WANDB_MODES:
            modes = ", ".join(WANDB_MODES)
            raise ConfigError(f"logger.wandb_mode {self.wandb_mode!r}: choose one of {modes}")
        if not self.wandb_project or set(self.wandb_project) & set("/\\#?%:"):
            raise ConfigError(f"logger.wandb_project {self.wandb_project!r}: write a name without any of / \\ # ? % :")
