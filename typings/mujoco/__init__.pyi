# MuJoCo's wheel holds compiled modules without type information: everything in it is untyped to pyright.
from typing import Any

def __getattr__(name: str) -> Any: ...
