"""Gymnasium environments: the batched one that trains, and a single robot as ``camp/Go2-v0``."""

import gymnasium

gymnasium.register(id="camp/Go2-v0", entry_point="camp.single_env:Go2Env")
