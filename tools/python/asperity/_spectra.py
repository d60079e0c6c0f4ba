"""Amplitude over frequency, for plots and data sets alike."""

from __future__ import annotations

from typing import Tuple

import numpy as np
import numpy.typing as npt


def amplitudes(values: npt.NDArray[np.float64], rate_hz: float) -> Tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Of evenly spaced values (N, ...), along the first axis: frequencies (F,), Hz, and amplitudes (F, ...). The mean is taken off,
    a Hann window laid on."""
    window = np.hanning(len(values)).reshape(-1, *(1,) * (values.ndim - 1))
    amplitude = 2.0 * np.abs(np.fft.rfft((values - values.mean(axis=0)) * window, axis=0)) / window.sum()
    return np.fft.rfftfreq(len(values), 1.0 / rate_hz), amplitude
