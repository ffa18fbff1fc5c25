#!/usr/bin/env python3
"""Rewrites an HDF5 file in the library's first format, which has no checksums: old_format.py FROM TO."""

import sys

import h5py


def copy(source, target):
    for key, value in source.attrs.items():
        target.attrs[key] = value
    if isinstance(source, h5py.Dataset):
        return
    for name, one in source.items():
        if isinstance(one, h5py.Dataset):
            chunks = (1, *one.shape[1:]) if one.chunks and one.ndim > 1 and 0 not in one.shape else None
            copy(one, target.create_dataset(name, data=one[()], chunks=chunks, compression="gzip" if chunks else None))
        else:
            copy(one, target.create_group(name))


with h5py.File(sys.argv[1]) as before, h5py.File(sys.argv[2], "w", libver="earliest") as after:
    copy(before, after)
