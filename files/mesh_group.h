#pragma once

#include "cloth/cloth_mesh.h"
#include "files/hdf5_file.h"

namespace toile::files {

/// The contract's mesh group, which is in every file. Pattern and mass are left out where the mesh has none.
void write_mesh_group(Hdf5File& file, const ClothMesh& mesh, int deflate);

/// Reads /mesh: indices stored as integers of any width, positions and masses as any numbers. Pattern and mass may be
/// missing, one of the two pattern datasets may not. Checks types and shapes, not values.
ClothMesh read_mesh_group(const Hdf5File& file);

}  // namespace toile::files
