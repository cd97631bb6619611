"""The clip format: one expert motion, its files, their checks, mirror images and samples."""
