#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "skin/pose.h"

namespace toile::skin {

/// Finds poses that may be near a given one among a million, without holding them: each is kept as twelve coordinates,
/// the angles of some joints to those of reference poses. None of these differs between two poses by more than their
/// largest joint rotation (the triangle inequality), so poses far apart here are far apart; those near here are to be
/// compared. About 60 bytes a pose.
class PoseGrid {
  public:
    using Source = std::function<Pose(std::int64_t)>;
    static constexpr int size = 12;
    using Coordinates = std::array<float, size>;

    /// `pose(k)`, 0 <= k < count, gives the poses that references and coordinates are chosen from; they need not be
    /// those that are inserted. `angle` [rad]: how near is near; positive. Room is made for `count` poses.
    PoseGrid(const Source& pose, std::int64_t count, double angle);
    ~PoseGrid();

    Coordinates coordinates(const Pose& pose) const;  ///< of a finite pose
    /// Inserted poses are counted from 0. They are in one of several `layer`s, which are searched by themselves.
    void insert(const Coordinates& at, int layer = 0);
    /// Appends those of a layer whose coordinates are within `angle`, in no order, perhaps some twice.
    void find(const Coordinates& at, int layer, std::vector<std::int32_t>& found) const;

  private:
    class Chart;
    static constexpr int cell_size = 6;  // coordinates that make up a cell
    using Cell = std::array<std::int64_t, cell_size>;
    struct Entry {
        Coordinates at;
        std::int32_t next;  ///< in the same bucket, -1: none
        std::int32_t layer;
    };
    std::int64_t index(double coordinate) const;
    std::size_t bucket_of(const Cell& cell, int layer) const;

    double angle_;
    std::unique_ptr<Chart> chart_;
    std::vector<std::int32_t> bucket_;  ///< the last entry of each
    std::vector<Entry> entry_;
};

}  // namespace toile::skin
