#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cloth/types.h"
#include "files/dataset_file.h"
#include "files/hdf5_file.h"

namespace toile::files {

inline constexpr int predictions_version = 1;

/// Where predictions come from. Other programs write none of it.
struct PredictionsHeader {
    std::string predictor;            ///< names it in tables: "ridge"
    std::string options;              ///< what it was asked for and what came of the fit, TOML
    std::string dataset_config_hash;  ///< of the data set it predicts; may be empty
    std::string program_version;
};

/// Writes a predictions file (contract, "A predictions file is ..."), a few samples at a time: under another name
/// first, renamed by `finish`, so that a file of this name is whole. `/samples/id` (N) int64, `/samples/predicted`
/// (N,V,3) float32, chunked by sample, with checksums; root attributes `format`, `version` and those of the header. The
/// bytes depend on what is written alone.
class PredictionsWriter {
  public:
    /// Throws Error where the file cannot be made.
    PredictionsWriter(const std::string& path, const PredictionsHeader& header, int64_t sample_count, int vertex_count);
    ~PredictionsWriter();  ///< without `finish`: leaves nothing behind
    PredictionsWriter(const PredictionsWriter&) = delete;
    PredictionsWriter& operator=(const PredictionsWriter&) = delete;

    /// Appends samples: ids `[n]` and r̂ `[n x V x 3]` [m]. Throws Error if the sizes do not fit, or the disk is full.
    void write(std::span<const int64_t> id, std::span<const float> predicted);
    /// Error unless all samples were written.
    void finish();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Reads a predictions file, which any program may have written, with floating point and integers of any width. Holds
/// the ids alone; positions are read on demand, so that memory does not grow beyond two numbers a sample.
class PredictionsReader {
  public:
    /// Throws Error with "file:/dataset" for the first thing that keeps it from being read: another type or shape, ids
    /// that repeat, an attribute `predictor` that cannot name anything, a file of another version.
    explicit PredictionsReader(const std::string& path);

    const std::string& path() const { return file_.path(); }
    /// What to call it: the attribute `predictor`, or else the file's name without its ending.
    const std::string& predictor() const { return header_.predictor; }
    const PredictionsHeader& header() const { return header_; }  ///< what the file lacks is empty
    const std::vector<int64_t>& id() const { return id_; }       ///< `[N]` in the file's order
    int64_t sample_count() const { return static_cast<int64_t>(id_.size()); }
    int vertex_count() const { return vertex_count_; }
    bool has(int64_t id) const { return slot_of(id).has_value(); }
    /// r̂ `[V x 3]` [m] of the sample `id`. Throws Error where the file has none.
    Positions read(int64_t id) const;
    /// r̂ `[n x V x 3]` [m] of the samples `id`, in their order.
    std::vector<double> read(std::span<const int64_t> id) const;

  private:
    std::optional<int64_t> slot_of(int64_t id) const;

    Hdf5File file_;
    PredictionsHeader header_;
    int vertex_count_ = 0;
    std::vector<int64_t> id_;
    std::vector<std::pair<int64_t, int64_t>> sorted_;  ///< id, slot; by id
};

/// Something wrong with a dataset's type or shape.
struct StructureDefect {
    std::string dataset;  ///< "/samples/id"
    std::string what;     ///< "missing"
};
/// Everything wrong with the types and shapes of a predictions file.
std::vector<StructureDefect> predictions_structure_defects(const Hdf5File& file);
/// Ids with their slots, by id.
std::vector<std::pair<int64_t, int64_t>> sorted_ids(const std::vector<int64_t>& id);

/// Ids `[n]` of the accepted samples of a data set that are in one of `splits` (0 train, 1 validation, 2 test), in the
/// data set's order.
std::vector<int64_t> accepted_ids(const DatasetReader& dataset, const std::vector<int>& splits);

/// Whether predictions can be judged by a data set's accepted samples of `splits`. Throws Error with the mend for the
/// first thing that forbids it: an empty file, another number of vertices, predictions that name another data set, an
/// id that is no sample of it, a split of no accepted sample, accepted samples that are not predicted (their number
/// and the first of them), a prediction of one of them that is not finite. Reads every prediction once, one at a time.
void check_predictions(const PredictionsReader& predictions, const DatasetReader& dataset,
                       const std::vector<int>& splits);

}  // namespace toile::files
