#!/usr/bin/env python3
"""Rewrites an HDF5 file in the library's first format, which has no checksums: old_format.py FROM TO."""

import sys

import h5py

with h5py.File(sys.argv[1]) as source, h5py.File(sys.argv[2], "w", libver="earliest") as target:
    for key, value in source.attrs.items():
        target.attrs[key] = value
    for name in source:
        source.copy(name, target, expand_external=True)
