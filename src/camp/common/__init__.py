"""The ground: errors, checks, files, paths, random streams, processes, threads. It imports nothing of camp."""
