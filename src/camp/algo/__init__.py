"""CAMP's learning parts: PPO, the conditional style prior, the skill prior and imitation."""
