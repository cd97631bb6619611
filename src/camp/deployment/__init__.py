"""Policies that leave the project: ONNX, metadata, packages. Importing it needs no torch."""
