#pragma once

#include <optional>
#include <string>
#include <vector>

#include "files/dataset_file.h"
#include "generate/export.h"
#include "skin/skinning.h"

namespace toile::generate {

/// The samples of a data set that an export is about, in its order, each read when it is asked for.
class ExportSamples {
  public:
    struct Entry {
        int slot = 0;
        int64_t id = 0;
        int split = 0, status = 0;
    };

    /// Throws Error where the data set cannot be read, or has indices out of range.
    explicit ExportSamples(const ExportOptions& options);

    const files::DatasetHeader& header() const { return reader_.header(); }
    const std::vector<Entry>& entry() const { return entry_; }  ///< `[N]` those selected
    int count() const { return static_cast<int>(entry_.size()); }
    int not_finite() const { return not_finite_; }
    int dataset_count() const { return reader_.sample_count(); }

    /// Absent where the scene has none, or it is not asked for.
    const std::optional<skin::Body>& body() const { return body_; }
    bool skinned_linearly() const { return skinning_ == skin::SkinningMethod::linear; }

    Positions cloth(int k) const;          ///< `[V x 3]` of entry k
    Positions pose(int k) const;           ///< `[J x 3]`; with a body
    Positions body_position(int k) const;  ///< `[Vb x 3]`; with a body

    /// Says how far the work has come; throws Interrupted if someone asked it to end.
    void step(const char* stage, int done) const;

  private:
    void select();
    bool is_finite(int slot) const;

    ExportOptions options_;
    files::DatasetReader reader_;
    std::vector<Entry> entry_;
    int not_finite_ = 0;
    std::optional<skin::Body> body_;
    skin::SkinningMethod skinning_ = skin::SkinningMethod::linear;
};

}  // namespace toile::generate
