"""Train the recurrent network that the benchmark of slip detectors compares with.

Nothing else needs PyTorch.

    python -m tools.detector_training.recurrent [--trials 1350] [--events 450] [--disturbances
        300] [--out weights.json]

The network is small, as those of the literature that judge one tactile signal are: one layer of
gated recurrent units (K. Cho et al., EMNLP 2014), which is fed every 2 ms. It sees signals of the
same generators as the trees of `fast`.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.slip import recurrent
from benchmarks.slip.recordings import Recording
from fingertip.foundation.jit import compiled
from tools.detector_training.fit import load_signals
from tools.detector_training.signals import TrainingSignal

HIDDEN = 16
EPOCHS = 40
CROP_TICKS = 750
BATCH = 64
RATE = 4e-3
SEED = 1
ONSET_S = 0.06
ONSET_WEIGHT = 4.0
"""Time at the start of a slip that counts more [s], and its weight: the delay is decided there."""


def main() -> None:
    """Train, and write the weights."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--trials", type=int, default=1350)
    parser.add_argument("--events", type=int, default=450)
    parser.add_argument("--disturbances", type=int, default=300)
    parser.add_argument(
        "--cache", type=Path, help="file that keeps the signals from one training to the next"
    )
    parser.add_argument(
        "--out", type=Path, default=Path(recurrent.__file__).with_name(recurrent.TABLE)
    )
    arguments = parser.parse_args()
    sizes = {name: getattr(arguments, name) for name in ("trials", "events", "disturbances")}
    signals = load_signals(arguments.cache, sizes)
    with compiled():
        rows = [make_rows(item) for item in signals]

    print(
        f"{len(rows)} signals, {sum(len(row[1]) for row in rows) * recurrent.TICK_S / 60:.0f} min",
        flush=True,
    )
    arguments.out.write_text(json.dumps(train(rows)) + "\n", encoding="utf-8")


def make_rows(item: TrainingSignal) -> tuple[Any, Any, Any]:
    """Return inputs, labels and weights of each tick of a signal."""
    signal = item.signal
    inputs = recurrent.find_inputs(item.design, Recording(signal, ()))
    time_s = np.arange(1, len(inputs) + 1) * recurrent.TICK_S
    labels = np.zeros(len(inputs))
    weights = np.ones(len(inputs))
    weights[time_s < max(0.3, signal.alarms_from_s)] = 0.0

    for slide in signal.slides:
        during = (time_s > slide.onset_s) & (time_s <= slide.end_s)
        labels[during] = 1.0
        weights[(time_s > slide.motion_s) & (time_s <= slide.onset_s)] = 0.0
        weights[(time_s > slide.end_s) & (time_s <= slide.end_s + 0.06)] = 0.0
        weights[during & (time_s <= slide.onset_s + ONSET_S)] = ONSET_WEIGHT

    return inputs.astype(np.float32), labels.astype(np.float32), weights.astype(np.float32)


def train(rows: list[tuple[Any, Any, Any]]) -> dict[str, Any]:
    """Train on crops of the signals, and return the weights, rounded to six digits."""
    import torch

    torch.manual_seed(SEED)
    rng = np.random.default_rng(SEED)
    network = torch.nn.GRU(recurrent.INPUTS, HIDDEN, batch_first=True)
    output = torch.nn.Linear(HIDDEN, 1)
    parameters = [*network.parameters(), *output.parameters()]
    optimizer = torch.optim.Adam(parameters, lr=RATE)
    steps = EPOCHS * max(1, len(rows) // BATCH)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, RATE, total_steps=steps)

    for step in range(steps):
        batch = [_crop(rows[i], rng) for i in rng.integers(0, len(rows), BATCH)]
        inputs, labels, weights = (
            torch.from_numpy(np.stack(part)) for part in zip(*batch, strict=True)
        )
        logits = output(network(inputs)[0])[..., 0]
        loss = torch.nn.functional.binary_cross_entropy_with_logits(logits, labels, weights)
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(parameters, 1.0)
        optimizer.step()
        schedule.step()
        if step % 100 == 0 or step == steps - 1:
            print(f"step {step} of {steps}: loss {loss.item():.4f}", flush=True)

    named = {**dict(network.named_parameters()), "output": output.weight, "bias": output.bias}
    rounded = np.vectorize(lambda value: float(f"{value:.6g}"))
    return {name: rounded(value.detach().numpy()).tolist() for name, value in named.items()}


def _crop(row: tuple[Any, Any, Any], rng: np.random.Generator) -> tuple[Any, Any, Any]:
    """Cut a piece of `CROP_TICKS` out of a signal; a shorter one
    is filled up with what does not count.
    """
    length = len(row[1])
    first = int(rng.integers(0, max(1, length - CROP_TICKS + 1)))
    parts = [part[first : first + CROP_TICKS] for part in row]
    fill = CROP_TICKS - len(parts[1])

    if fill:
        parts = [np.concatenate((part, np.repeat(part[-1:], fill, axis=0))) for part in parts]
        parts[2][-fill:] = 0.0

    return parts[0], parts[1], parts[2]


if __name__ == "__main__":
    main()
