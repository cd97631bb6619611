"""How every command runs: arguments, errors in one line, exit codes."""
