#include "evaluate/displacement_components.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <vector>

#include "cloth/parallel.h"

namespace toile::evaluate {
namespace {

using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Variance below this share of the largest is that of float32's rounding.
constexpr double noise_variance = 1e-10;
constexpr Eigen::Index block_rows = 128;

/// Some of the train split, ascending; all of it where it is small.
std::vector<int> drawn_slots(const std::vector<int>& train, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<int> drawn;
    std::sample(train.begin(), train.end(), std::back_inserter(drawn), most_drawn, random);
    return drawn;
}

FloatRows centred_rows(const PredictorData& data, const std::vector<int>& slot, const Eigen::VectorXd& mean) {
    FloatRows rows(static_cast<Eigen::Index>(slot.size()), mean.size());
    for (size_t i = 0; i < slot.size(); ++i) {
        const Positions one = data.displacement(slot[i]);
        rows.row(static_cast<Eigen::Index>(i)) =
            (Eigen::Map<const Eigen::VectorXd>(one.data(), one.size()) - mean).transpose().cast<float>();
    }
    return rows;
}

/// Rows times their transpose in float64, block by block: a block does not depend on the threads.
Eigen::MatrixXd gram(const FloatRows& rows, int jobs) {
    const Eigen::Index count = rows.rows(), blocks = (count + block_rows - 1) / block_rows;
    Eigen::MatrixXd result(count, count);
    parallel_for(static_cast<int>(blocks * (blocks + 1) / 2), jobs, [&](int, int index) {
        Eigen::Index i = 0, j = index;
        while (j > i) j -= ++i;
        const Eigen::Index a = i * block_rows, b = j * block_rows;
        const Eigen::Index n = std::min(block_rows, count - a), m = std::min(block_rows, count - b);
        result.block(a, b, n, m).noalias() =
            rows.middleRows(a, n).cast<double>().eval() * rows.middleRows(b, m).cast<double>().transpose().eval();
        if (i != j) result.block(b, a, m, n) = result.block(a, b, n, m).transpose();
    });
    return result;
}

/// How many of the variances, which fall, to keep.
Eigen::Index kept(const Eigen::VectorXd& variance, const ComponentOptions& options) {
    Eigen::Index sound = 0;
    while (sound < variance.size() && variance[sound] > noise_variance * variance[0] && variance[sound] > 0) ++sound;
    if (options.components > 0) return std::min<Eigen::Index>(sound, options.components);
    const double wanted = options.explained_variance * variance.head(sound).sum();
    Eigen::Index count = 0;
    for (double sum = 0; count < std::min<Eigen::Index>(sound, options.most) && sum < wanted; ++count)
        sum += variance[count];
    return count;
}

/// Rows' transpose times `weights` `[n x k]`: each thread has its own block of the M numbers.
Eigen::MatrixXd combined(const FloatRows& rows, const Eigen::MatrixXd& weights, int jobs) {
    const Eigen::Index size = rows.cols(), width = 512, blocks = (size + width - 1) / width;
    Eigen::MatrixXd result(size, weights.cols());
    parallel_for(static_cast<int>(blocks), jobs, [&](int, int block) {
        const Eigen::Index first = block * width, count = std::min(width, size - first);
        result.middleRows(first, count).noalias() =
            rows.middleCols(first, count).cast<double>().transpose().eval() * weights;
    });
    return result;
}

}  // namespace

Positions mean_displacement(const PredictorData& data) {
    Positions sum = Positions::Zero(data.vertex_count(), 3);
    for (const int slot : data.train()) sum += data.displacement(slot);
    return sum / static_cast<double>(data.train().size());
}

DisplacementComponents displacement_components(const PredictorData& data, const ComponentOptions& options) {
    DisplacementComponents result;
    const Positions mean = mean_displacement(data);
    result.mean = Eigen::Map<const Eigen::VectorXd>(mean.data(), mean.size());
    const std::vector<int> slot = drawn_slots(data.train(), options.seed);
    result.drawn = static_cast<int>(slot.size());
    const FloatRows rows = centred_rows(data, slot, result.mean);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram(rows, options.jobs));
    const Eigen::VectorXd variance = solver.eigenvalues().reverse();
    const Eigen::Index count = kept(variance, options);
    Eigen::MatrixXd weights = solver.eigenvectors().rowwise().reverse().leftCols(count);
    for (Eigen::Index k = 0; k < count; ++k) weights.col(k) /= std::sqrt(variance[k]);
    result.direction = combined(rows, weights, options.jobs);
    return result;
}

}  // namespace toile::evaluate
