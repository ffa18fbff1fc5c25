#include "evaluate/image_predictor.h"

#include "cloth/error.h"
#include "pattern/rasterizer.h"

namespace toile::evaluate {
namespace {

pattern::PixelWeights reading_of(const PredictorData& data) {
    const files::DatasetHeader& header = data.dataset().header();
    const std::string& path = data.dataset().file().path();
    if (!header.image)
        throw Error("the data set has no images", path + ":/image",
                    "choose another --predictor, or generate with [image]");
    check_cloth_mesh(header.mesh, path);
    const Positions& at = header.image->pattern_pixel;
    const double last = header.image->size - 1;
    if (last < 1) throw Error("the images are smaller than two pixels", path + ":/image/mask");
    for (Eigen::Index p = 0; p < at.rows(); ++p)
        if (!(at(p, 0) >= 0 && at(p, 0) < header.image->layers && at(p, 1) >= 0 && at(p, 1) <= last && at(p, 2) >= 0 &&
              at(p, 2) <= last))
            throw Error("pattern position " + std::to_string(p) + " is not a place in the image",
                        path + ":/image/pattern_pixel");
    pattern::PatternLayout layout;
    layout.size = header.image->size;
    layout.layers = header.image->layers;
    layout.pattern_pixel = at;
    return pattern::reading_weights(header.mesh, layout);
}

class ImagePredictor final : public Predictor {
  public:
    explicit ImagePredictor(const PredictorData& data)
        : reading_(reading_of(data)),
          layers_(data.dataset().header().image->layers),
          size_(data.dataset().header().image->size) {}

    std::string name() const override { return "image"; }
    bool needs_image() const override { return true; }

    Positions displacement(const PredictorInput& input) const override {
        return pattern::read_image(reading_, input.image, layers_, size_);
    }

    std::vector<FitFact> facts() const override {
        return {{"size", static_cast<double>(size_)}, {"layers", static_cast<double>(layers_)}};
    }

  private:
    pattern::PixelWeights reading_;
    int layers_, size_;
};

}  // namespace

std::unique_ptr<Predictor> make_image_predictor(const PredictorData& data) {
    return std::make_unique<ImagePredictor>(data);
}

}  // namespace toile::evaluate
