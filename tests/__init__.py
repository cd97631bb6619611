"""A package with a name, so that no installed one of the same name takes its place."""
