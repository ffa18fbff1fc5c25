"""Poses as a network's input."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def rotation_matrices(pose: np.ndarray) -> np.ndarray:
    """R(θ) `[... x 3 x 3]` of axis-angle vectors θ `[... x 3]` [rad]."""
    theta = np.asarray(pose, np.float64)
    angle = np.linalg.norm(theta, axis=-1)[..., np.newaxis, np.newaxis]
    cross = np.zeros((*theta.shape[:-1], 3, 3))
    cross[..., 2, 1], cross[..., 0, 2], cross[..., 1, 0] = (theta[..., k] for k in range(3))
    cross -= np.swapaxes(cross, -1, -2).copy()
    # R = 1 + (sin a / a) K + ((1 - cos a) / a²) K²; np.sinc(x) is sin(πx)/(πx), so that a = 0 needs no case of its own
    sine = np.sinc(angle / np.pi)
    cosine = 0.5 * np.sinc(angle / (2 * np.pi)) ** 2
    return np.eye(3) + sine * cross + cosine * (cross @ cross)


def pose_features(pose: np.ndarray, joints: Sequence[int] | None = None) -> np.ndarray:
    """Rotation matrices of `joints` (all by default), less the bind pose's, row-major: `[... x 9·len(joints)]` float32.

    pose: `[... x J x 3]` [rad]. They are zero in the bind pose and, unlike angles, smooth everywhere.
    """
    theta = np.asarray(pose)
    chosen = theta if joints is None else theta[..., list(joints), :]
    return (rotation_matrices(chosen) - np.eye(3)).reshape(*chosen.shape[:-2], -1).astype(np.float32)
