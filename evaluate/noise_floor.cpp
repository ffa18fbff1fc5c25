#include "evaluate/noise_floor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "cloth/error.h"
#include "files/noise_file.h"

namespace toile::evaluate {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Values of a drape taken for a prediction of another one.
QuantityValues pair_values(const ClothJudge& judge, const Positions& configured, const Positions& variant) {
    const JudgedTarget target = judge.target(configured);
    QuantityValues values = judge.judge(variant, target);
    const QuantityValues own = judge.judge(configured, target);
    for (int q = 0; q < quantity_count; ++q) {
        const auto k = static_cast<size_t>(q);
        if (quantity_kind(q).of_the_cloth) values[k] = std::abs(values[k] - own[k]);
    }
    return values;
}

bool is_same(const Triangles& a, const Triangles& b) {
    return a.rows() == b.rows() && a == b;
}

void check_mesh(const ClothMesh& theirs, const ClothMesh& ours, const std::string& path) {
    const bool same = is_same(theirs.triangle, ours.triangle) &&
                      is_same(theirs.pattern_triangle, ours.pattern_triangle) &&
                      theirs.pattern_position.rows() == ours.pattern_position.rows();
    if (!same)
        throw Error("the noise floor is of another mesh than the data set's", path,
                    "measure it with toile evaluate noise DATASET");
}

}  // namespace

NoiseFloor read_noise_floor(const std::string& path, const ClothJudge& judge) {
    const files::NoiseReader reader(path);
    check_mesh(reader.header().mesh, judge.mesh(), path);
    std::vector<std::vector<QuantityValues>> pair(reader.header().variant.size());
    NoiseFloor floor;
    floor.source = path;
    for (std::int64_t slot = 0; slot < reader.sample_count(); ++slot) {
        const files::NoiseRecord record = reader.read(slot);
        for (size_t k = 0; record.status == 0 && k < record.variant.size(); ++k) {
            const Positions& variant = record.variant[k].cloth;
            if (record.variant[k].status != 0 || !variant.allFinite() || !record.cloth.allFinite()) continue;
            pair[k].push_back(pair_values(judge, record.cloth, variant));
            ++floor.samples;
        }
    }
    if (floor.samples == 0)
        throw Error("the noise file has no pair of drapes within the gate", path, "measure it on more poses (--share)");
    floor.value.fill(not_a_number);
    for (const std::vector<QuantityValues>& variant : pair)
        for (size_t q = 0; q < floor.value.size(); ++q) {
            std::vector<double> value;
            for (const QuantityValues& one : variant) value.push_back(one[q]);
            const auto kind = quantity_kind(static_cast<int>(q));
            const double here = gathered(kind.root_of_squares ? Gather::root_of_mean_square : Gather::mean, value);
            if (!(floor.value[q] >= here)) floor.value[q] = here;
        }
    return floor;
}

}  // namespace toile::evaluate
