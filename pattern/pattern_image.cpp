#include "pattern/pattern_image.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "cloth/error.h"
#include "pattern/rasterizer.h"

namespace toile::pattern {
namespace {

constexpr double correction_damping = 0.01;

using Factor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

/// Whether every part of the pattern finds a place.
bool fits(const ClothMesh& mesh, const std::vector<int>& triangle_panel, const ImageOptions& options) {
    try {
        lay_out(mesh, pattern_charts(mesh, triangle_panel), options.layout, options.size);
    } catch (const Error&) {
        return false;
    }
    return true;
}

}  // namespace

void ResamplingError::add(const Positions& displacement, const Positions& read_back) {
    for (Eigen::Index v = 0; v < displacement.rows(); ++v) {
        const double squared_distance = (displacement.row(v) - read_back.row(v)).squaredNorm();
        largest = std::max(largest, std::sqrt(squared_distance));
        squared_sum += squared_distance;
    }
    count += displacement.rows();
}

double ResamplingError::root_mean_square() const {
    return count > 0 ? std::sqrt(squared_sum / static_cast<double>(count)) : 0.0;
}

struct PatternImage::Impl {
    PatternLayout layout;
    Raster raster;
    PixelWeights reading;
    PixelWeights reading_transposed;
    Factor factor;  ///< of R Rᵀ + λ 1
};

PatternImage::PatternImage(const ClothMesh& mesh, const std::vector<int>& triangle_panel, const ImageOptions& options)
    : impl_(std::make_unique<Impl>()) {
    if (options.size < 16 || options.size > 4096)
        throw Error("image.size " + std::to_string(options.size) + " is not between 16 and 4096", "image.size");
    impl_->layout = lay_out(mesh, pattern_charts(mesh, triangle_panel), options.layout, options.size);
    impl_->raster = rasterize(mesh, impl_->layout);
    impl_->reading = reading_weights(mesh, impl_->layout);
    impl_->reading_transposed = impl_->reading.transpose();
    Eigen::SparseMatrix<double> gram = impl_->reading * impl_->reading_transposed;
    Eigen::SparseMatrix<double> identity(gram.rows(), gram.rows());
    identity.setIdentity();
    impl_->factor.compute(gram + correction_damping * identity);
}

PatternImage::~PatternImage() = default;
PatternImage::PatternImage(PatternImage&&) noexcept = default;
PatternImage& PatternImage::operator=(PatternImage&&) noexcept = default;

const PatternLayout& PatternImage::layout() const {
    return impl_->layout;
}
const std::vector<uint8_t>& PatternImage::mask() const {
    return impl_->raster.mask;
}

std::vector<float> PatternImage::image(const Positions& displacement) const {
    const size_t area = static_cast<size_t>(impl_->layout.size) * impl_->layout.size;
    std::vector<float> image(channels() * area, 0.0f);
    if (!displacement.allFinite()) {
        std::fill(image.begin(), image.end(), std::numeric_limits<float>::quiet_NaN());
        return image;
    }
    Positions pixel = impl_->raster.vertex_to_pixel * displacement;
    const Eigen::MatrixXd missed = displacement - Positions(impl_->reading * pixel);
    pixel += impl_->reading_transposed * Eigen::MatrixXd(impl_->factor.solve(missed));
    for (int layer = 0; layer < impl_->layout.layers; ++layer)
        for (int component = 0; component < 3; ++component)
            for (size_t i = 0; i < area; ++i)
                image[(3 * layer + component) * area + i] =
                    static_cast<float>(pixel(static_cast<Eigen::Index>(layer * area + i), component));
    return image;
}

Positions PatternImage::read(const std::vector<float>& image) const {
    return read_image(impl_->reading, image, impl_->layout.layers, impl_->layout.size);
}

AutoImageSize auto_image_size(const ClothMesh& mesh, const std::vector<int>& triangle_panel,
                              const ImageOptions& options, const std::vector<Positions>& displacement) {
    AutoImageSize result;
    for (const int size : {32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024}) {
        ImageOptions at = options;
        at.size = size;
        if (!fits(mesh, triangle_panel, at)) continue;
        const PatternImage pattern_image(mesh, triangle_panel, at);
        result = {size, {}, false};
        for (const Positions& d : displacement) result.error.add(d, pattern_image.read(pattern_image.image(d)));
        result.reached = result.error.largest <= options.max_error;
        if (result.reached) break;
    }
    if (result.size == 0) throw Error("the pattern fits no image of up to 1024 pixels", "image.size");
    return result;
}

Positions fold_probe(const Positions& rest_position) {
    const double wave = 2 * std::numbers::pi / 0.04;
    Positions probe(rest_position.rows(), 3);
    for (Eigen::Index v = 0; v < probe.rows(); ++v) {
        const double x = rest_position(v, 0), y = rest_position(v, 1), z = rest_position(v, 2);
        probe.row(v) << 0.002 * std::sin(wave * (0.6 * y + 0.8 * z)), 0.002 * std::cos(wave * (0.6 * x + 0.8 * y)),
            0.005 * std::sin(wave * (0.8 * x + 0.6 * y)) * std::cos(0.5 * wave * z);
    }
    return probe;
}

}  // namespace toile::pattern
