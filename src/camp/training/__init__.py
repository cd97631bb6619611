"""The training loop and what belongs to it: collection, live readings, alarms, progress, imitation."""
