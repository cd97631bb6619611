"""Warp launches that run as one unit, in the order of torch's own work."""

from __future__ import annotations

from collections.abc import Callable

import torch
import warp as wp


class CudaGraph:
    """A fixed sequence of Warp launches: one CUDA graph, or launch by launch on Warp's CPU device.

    The graph reads and writes the arrays that it was captured with: their contents may change, but none of them
    may be replaced.

    Args:
        launch: makes the launches. On a CUDA device it runs twice here: once for real, which compiles every kernel
            and fills every cache, and once for the capture; so it must be harmless.
        device: where the arrays are.
    """

    def __init__(self, launch: Callable[[], None], device: torch.device):
        self._launch, self._device = launch, device
        self._stream: wp.Stream | None = None
        self._graph: wp.Graph | None = None
        if device.type == "cuda":
            torch.cuda.synchronize(device)
            with wp.ScopedDevice(str(device)):
                launch()
                with wp.ScopedCapture() as capture:
                    launch()
                wp.synchronize_device()
            self._graph = capture.graph

    @property
    def captured(self) -> bool:
        """Whether a CUDA graph is what runs."""
        return self._graph is not None

    def run(self) -> None:
        """Start the launches; on a CUDA device they follow what torch's current stream holds, without waiting."""
        if self._graph is None:
            self.run_directly()
        else:
            wp.capture_launch(self._graph, stream=self._torch_stream())

    def run_directly(self) -> None:
        """The same, launch by launch."""
        if self._device.type == "cuda":
            with wp.ScopedStream(self._torch_stream()):
                self._launch()
        else:
            with wp.ScopedDevice(str(self._device)):
                self._launch()

    def _torch_stream(self) -> wp.Stream:
        """Torch's current stream; wrapped anew only when it is another one than before."""
        current = torch.cuda.current_stream(self._device)
        if self._stream is None or self._stream.cuda_stream != current.cuda_stream:
            self._stream = wp.stream_from_torch(current)
        return self._stream
