"""From displacements and images of displacements to cloth."""

from __future__ import annotations

import numpy as np

from toile_data.error import DataError


def reconstruct(embedded: np.ndarray, frame: np.ndarray, displacement: np.ndarray) -> np.ndarray:
    """Cloth r = r̃ + q·d·q⁻¹ `[... x V x 3]` [m].

    embedded: r̃ `[... x V x 3]` [m]; frame: q `[... x V x 4]`, unit quaternions (w,x,y,z); displacement: d = (Δu, Δv, Δn)
    `[... x V x 3]` [m]. Float32 in gives float32.
    """
    w, axis = frame[..., :1], frame[..., 1:]
    turned = 2 * np.cross(axis, displacement)
    return embedded + displacement + w * turned + np.cross(axis, turned)


def read_image(
    image: np.ndarray, pattern_pixel: np.ndarray, triangle: np.ndarray, pattern_triangle: np.ndarray
) -> np.ndarray:
    """Displacements `[... x V x 3]` [m] that images hold: bilinear at each pattern position, averaged over a seam vertex'.

    image: `[... x C x H x W]` [m], channel 3·layer + component; pattern_pixel: `/image/pattern_pixel` `[P x 3]` layer,
    column, row; triangle, pattern_triangle: of `/mesh`, `[F x 3]`. They differ from the displacements that were
    rasterised by at most the attribute `resampling_error`. A vertex of no triangle gets NaN.
    """
    *leading, channels, height, width = image.shape
    if channels % 3 != 0 or int(pattern_pixel[:, 0].max()) >= channels // 3:
        raise DataError(f"an image of {channels} channels does not have the layers of these pattern positions")
    pair = np.unique(np.stack([triangle.ravel(), pattern_triangle.ravel()], axis=1), axis=0)
    value = _bilinear(image.reshape(-1, channels // 3, 3, height, width), pattern_pixel[pair[:, 1]])
    vertex, first, count = np.unique(pair[:, 0], return_index=True, return_counts=True)
    read = np.full((value.shape[0], int(triangle.max()) + 1, 3), np.nan, value.dtype)
    read[:, vertex] = np.add.reduceat(value, first, axis=1) / count[:, np.newaxis]
    return read.reshape(*leading, -1, 3)


def _bilinear(image: np.ndarray, pixel: np.ndarray) -> np.ndarray:
    """`[N x K x 3]` of images `[N x layers x 3 x H x W]` at K places (layer, column, row)."""
    height, width = image.shape[-2:]
    layer = pixel[:, 0].astype(int)
    column = np.clip(np.floor(pixel[:, 1]).astype(int), 0, width - 2)
    row = np.clip(np.floor(pixel[:, 2]).astype(int), 0, height - 2)
    x, y = (pixel[:, 1] - column)[:, np.newaxis], (pixel[:, 2] - row)[:, np.newaxis]
    # an index array on each side of the component's slice: the places come first
    at = {(j, i): np.moveaxis(image[:, layer, :, row + j, column + i], 0, 1) for j in (0, 1) for i in (0, 1)}
    return (1 - y) * ((1 - x) * at[0, 0] + x * at[0, 1]) + y * ((1 - x) * at[1, 0] + x * at[1, 1])
