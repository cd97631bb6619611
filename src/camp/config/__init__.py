"""The typed configuration: schema, composition, and Hydra's errors in plain words."""
