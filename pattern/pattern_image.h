#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cloth/cloth_mesh.h"
#include "pattern/pattern_layout.h"

namespace toile::pattern {

struct ImageOptions {
    int size = 0;               ///< height and width in pixels, 16 to 4096; 0 = the smallest under `max_error`
    double max_error = 0.0005;  ///< largest error of mesh -> image -> mesh over all vertices [m], above 0
    int probe = 16;             ///< drapes that size = 0 is chosen on, 1 or more
    ImageLayout layout = ImageLayout::layers;
};

/// Error of mesh -> image -> mesh over the samples added: distances between a displacement and what is read back [m].
struct ResamplingError {
    double largest = 0;
    double squared_sum = 0;
    int64_t count = 0;  ///< vertices added

    void add(const Positions& displacement, const Positions& read_back);
    double root_mean_square() const;
};

/// Displacements (Δu, Δv, Δn) as images over the pattern and back (method.md, Section 1, step 5).
///
/// With W the barycentric rasterisation at pixel centres and R the contract's reading (bilinear at the pattern
/// positions, averaged over those of a seam vertex), an image is
///     I = W d + Rᵀ (R Rᵀ + λ 1)⁻¹ (d − R W d),   λ = 0.01,
/// the image nearest to W d that reads back almost exactly: W alone misses each vertex by its share of the bend of d
/// over a pixel. On a dozen drapes of a T-shirt of 900 vertices at 128 pixels (5.7 mm) the largest error falls from 8.1
/// to 0.32 mm and the root mean square from 1.0 to 0.03 mm, while the image's second differences grow by a tenth. A
/// smaller λ would read back better still, but ring where pixels are too coarse for the mesh; so the error shows it
/// instead, and `auto_image_size` takes finer pixels.
///
/// All of it is prepared once; `image` and `read` are const and may run from several threads.
class PatternImage {
  public:
    /// `triangle_panel` `[F]` orders the layers. Throws Error as `lay_out` does. `options.size` must not be 0.
    PatternImage(const ClothMesh& mesh, const std::vector<int>& triangle_panel, const ImageOptions& options);
    ~PatternImage();
    PatternImage(PatternImage&&) noexcept;
    PatternImage& operator=(PatternImage&&) noexcept;

    const PatternLayout& layout() const;
    int channels() const { return 3 * layout().layers; }
    const std::vector<uint8_t>& mask() const;  ///< `[layers x size x size]` 1 where the pattern covers a pixel's centre

    /// `[channels x size x size]` [m], channel 3·layer + component, zero away from the pattern. All of it NaN where
    /// `displacement` `[V x 3]` is not finite.
    std::vector<float> image(const Positions& displacement) const;
    /// `[V x 3]` [m] as the contract tells readers to read it.
    Positions read(const std::vector<float>& image) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// What `size = "auto"` comes to.
struct AutoImageSize {
    int size = 0;
    ResamplingError error;  ///< of the given displacements at this size
    bool reached = false;   ///< false: even the largest size misses `max_error`
};

/// The smallest of 32, 48, 64, 96 ... 1024 pixels at which no given displacement `[V x 3]` is read back with an error
/// above `options.max_error`. The choice depends on the arguments alone, so that shards agree: give it what the
/// configuration determines.
AutoImageSize auto_image_size(const ClothMesh& mesh, const std::vector<int>& triangle_panel,
                              const ImageOptions& options, const std::vector<Positions>& displacement);

/// Displacements `[V x 3]` like those of a cloth in folds of 5 mm every 4 cm, standing in for drapes not yet made [m].
Positions fold_probe(const Positions& rest_position);

}  // namespace toile::pattern
