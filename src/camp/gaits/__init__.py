"""The vocabulary of gaits: schedules of foot contacts, and skills."""
