#pragma once

#include "cloth/cloth_mesh.h"
#include "evaluate/random.h"

namespace toile::evaluate {

// Meshes made by code: no two seeds give the same one. They carry no pattern and no mass, so their rest state is the
// rest position, of uniform density. Triangles of a grid meet along diagonals whose way is drawn; vertices are shaken
// within the surface by up to `shake` of an edge.

/// A tube open at both ends: `around * along` vertices, 3 V - 2 around edges. 53 x 56 is the size of the paper's shirt.
ClothMesh open_tube(int around, int along, double edge_length, double shake, Random& random);

/// A flat patch of `columns * rows` vertices.
ClothMesh flat_patch(int columns, int rows, double edge_length, double shake, Random& random);

/// A flat patch with vertices of three to a dozen neighbours: shaken widely, and edges flipped where the two triangles
/// beside them allow it.
ClothMesh irregular_patch(int columns, int rows, double edge_length, Random& random);

/// Two to four tubes and patches that do not touch, `vertices` in all or a little fewer, and vertices of no triangle.
ClothMesh several_pieces(int vertices, double edge_length, Random& random);

/// A patch with a fin sewn to its middle column, so that those edges have three triangles.
ClothMesh patch_with_fin(int columns, int rows, double edge_length, Random& random);

/// Gives the vertices new numbers, in a random order.
void renumber_vertices(ClothMesh& mesh, Random& random);

}  // namespace toile::evaluate
