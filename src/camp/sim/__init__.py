"""Simulators: many robots stepped together behind one protocol."""
