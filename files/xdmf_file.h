#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace toile::files {

/// A dataset (N,V,3) float32 of an HDF5 file, `file` relative to the XDMF file's folder: "dataset.h5",
/// "/samples/cloth".
struct XdmfArray {
    std::string file, dataset;
};

/// A mesh of which every sample has its positions.
struct XdmfMesh {
    std::string name;
    XdmfArray triangle;  ///< (F,3) int32
    XdmfArray position;  ///< (rows,V,3) float32
    std::vector<std::pair<std::string, XdmfArray>>
        attribute;  ///< vectors by vertex (rows,V,3) float32, with their names
    int64_t triangles = 0, vertices = 0;
    int64_t rows = 0;  ///< of `position` and of each attribute
};

/// Writes an XDMF file, a time series that refers to HDF5 datasets, a sample after the other. Each takes some two
/// kilobytes, and the file appears whole or not at all.
///
/// XDMF version 2 with hyperslabs: for ParaView's "XDMF Reader" and VTK's vtkXdmfReader. (Their Xdmf3 readers know no
/// hyperslabs.) Throws Error with the system's reason where it cannot be written.
class XdmfWriter {
  public:
    explicit XdmfWriter(const std::string& path);
    ~XdmfWriter();
    XdmfWriter(const XdmfWriter&) = delete;
    XdmfWriter& operator=(const XdmfWriter&) = delete;

    void begin_sample(const std::string& name, int64_t time);
    /// Row `row` of the mesh's positions and attributes, and numbers that hold for all of it.
    void add_mesh(const XdmfMesh& mesh, int64_t row, const std::vector<std::pair<std::string, int64_t>>& number);
    void end_sample();
    void commit();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace toile::files
