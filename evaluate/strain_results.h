#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "evaluate/quantile_tally.h"
#include "evaluate/strain_rate.h"
#include "evaluate/triangle_strain.h"
#include "evaluate/vertex_strain.h"
#include "files/metric_file.h"

namespace toile::evaluate {

/// How often each fault occurs.
using FaultCounts = std::array<std::int64_t, strain_fault_count>;

/// One quantity over all triangles or vertices of all frames.
struct StrainQuantity {
    std::string name;   ///< "triangle/stretch_1"
    std::string unit;   ///< "1" of stretches
    double origin = 0;  ///< what the tally's numbers count from: 1 of stretches, so that strain is told finely
    QuantileTally tally;

    double quantile(double share) const { return origin + tally.quantile(share); }
};

/// Few numbers of one frame.
struct StrainFrameFigures {
    std::string name;
    struct Surface {
        double median_1 = 0, p99_1 = 0, largest_1 = 0;                 ///< of the largest principal stretch
        double median_2 = 0, p1_2 = 0, smallest_2 = 0;                 ///< of the smallest within the surface
        double largest_rate = 0, largest_spin = 0, largest_error = 0;  ///< NaN without rates [1/s, rad/s, 1/s]
        FaultCounts fault{};
        std::int64_t rates_missing = 0;
    };
    Surface triangle, vertex;
};

/// What strain analysis found.
struct StrainSummary {
    std::vector<std::string> path;  ///< of the files written
    std::vector<std::string> note;  ///< for people: what was left out, and why
    std::vector<StrainQuantity> quantity;
    std::vector<StrainFrameFigures> frame;
    FaultCounts triangle_fault{}, vertex_fault{};
    std::int64_t triangle_rates_missing = 0, vertex_rates_missing = 0;
    bool rates = false;
    int triangles = 0, vertices = 0;

    const StrainQuantity& of(const std::string& name) const;
};

/// Adds a frame to the summary; frames come in their order.
void add_frame(StrainSummary& summary, const std::string& name, const std::vector<TriangleStrain>& triangle,
               const std::vector<VertexStrain>& vertex);
/// Adds the rates of frame k, in the order of the frames.
void add_rates(StrainSummary& summary, int k, const std::vector<StrainRate>& triangle,
               const std::vector<StrainRate>& vertex);

/// `rates`: whether there will be any.
StrainSummary empty_summary(bool rates, int triangles, int vertices);

/// Metrics with their distributions, and counts of faults.
std::vector<files::Metric> strain_metrics(const StrainSummary& summary);
/// The members of strain.json beside the metrics: `frames`, `quantity` with histograms, `faults`, `notes`.
nlohmann::ordered_json strain_members(const StrainSummary& summary);
/// A table for the terminal.
std::string strain_table(const StrainSummary& summary);

}  // namespace toile::evaluate
