#!/usr/bin/env python3
"""The smallest predictor: ridge regression from joint rotations to displacements.

    PYTHONPATH=python python/examples/ridge.py out/quick/dataset.h5 --out predictions.h5

Fits on the train split alone, predicts every accepted sample, prints the error by split beside that of the train split's
mean displacement, and writes a predictions file. The features are rotation matrices of the joints that move.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np

from toile_data import DataError, Dataset, pose_features, reconstruct, write_predictions


def fit(features: np.ndarray, target: np.ndarray, ridge: float) -> tuple[np.ndarray, np.ndarray]:
    """Weights `[D x M]` and offset `[M]` of the least squares of `[N x D]` to `[N x M]`, in the kernel form: N is small."""
    mean, offset = features.mean(axis=0), target.mean(axis=0)
    centred = (features - mean).astype(np.float64)
    gram = centred @ centred.T
    scale = ridge * max(np.trace(gram) / len(gram), 1e-12)
    weights = centred.T @ np.linalg.solve(gram + scale * np.eye(len(gram)), target - offset)
    return weights, offset - mean @ weights


def error(predicted: np.ndarray, cloth: np.ndarray) -> float:
    """Root mean square distance of vertices [m]."""
    return float(np.sqrt(((predicted - cloth) ** 2).sum(axis=-1).mean()))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("dataset")
    parser.add_argument("--out", required=True)
    parser.add_argument("--ridge", type=float, default=0.1, help="relative to the features' variance")
    options = parser.parse_args()
    train = Dataset(options.dataset, "train", ("pose", "displacement"))[:]
    joints = np.flatnonzero(np.abs(train["pose"]).max(axis=(0, 2)) > 0)
    displacement = train["displacement"].reshape(len(train["pose"]), -1)
    weights, offset = fit(pose_features(train["pose"], joints), displacement, options.ridge)

    every = Dataset(options.dataset, "all", ("pose", "cloth", "embedded", "frame", "split"))
    predicted = np.empty((len(every), *every.shape("cloth")), np.float32)
    mean = np.empty_like(predicted)
    cloth = np.empty_like(predicted)
    split = np.empty(len(every), int)
    for k, sample in enumerate(every):
        d = (pose_features(sample["pose"], joints) @ weights + offset).reshape(-1, 3)
        predicted[k] = reconstruct(sample["embedded"], sample["frame"], d)
        mean[k] = reconstruct(sample["embedded"], sample["frame"], displacement.mean(axis=0).reshape(-1, 3))
        cloth[k], split[k] = sample["cloth"], sample["split"]
    for number, name in enumerate(("train", "validation", "test")):
        of = split == number
        if of.any():
            print(f"{name:10} {of.sum():6} samples, error {1e3 * error(predicted[of], cloth[of]):7.2f} mm, "
                  f"of the mean displacement {1e3 * error(mean[of], cloth[of]):7.2f} mm")  # fmt: skip
    write_predictions(options.out, every.ids, predicted)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except DataError as fault:
        sys.exit(f"ridge: {fault}")
