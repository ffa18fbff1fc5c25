#include "generate/sample_sheet.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "cloth/topology.h"
#include "generate/rendering.h"
#include "generate/stored_body.h"
#include "simulate/certificate.h"

namespace toile::generate {
namespace {

constexpr int tile_width = 260, tile_height = 300, label_height = 34, header_height = 44, gap = 10, columns = 4;
constexpr Color skin_tone{0.62, 0.56, 0.52};

/// White at a stretch of 1, towards red at 1.25 and blue at 0.75.
Color stretch_color(double stretch) {
    const Color red{0.86, 0.08, 0.08}, blue{0.10, 0.25, 0.90};
    const double share = std::min(std::abs(stretch - 1) / 0.25, 1.0);
    Color color;
    for (int k = 0; k < 3; ++k) color[k] = 1 + share * ((stretch < 1 ? blue : red)[k] - 1);
    return color;
}

std::vector<Color> stretch_colors(const Topology& topology, const Eigen::VectorXd& rest_length,
                                  const Positions& cloth) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(cloth.rows()), count = sum;
    for (Eigen::Index e = 0; e < topology.edge.rows(); ++e) {
        const int a = topology.edge(e, 0), b = topology.edge(e, 1);
        const double stretch = (cloth.row(a) - cloth.row(b)).norm() / rest_length[e];
        for (const int v : {a, b}) {
            sum[v] += stretch;
            ++count[v];
        }
    }
    std::vector<Color> color;
    for (Eigen::Index v = 0; v < cloth.rows(); ++v)
        color.push_back(stretch_color(count[v] > 0 ? sum[v] / count[v] : 1));
    return color;
}

/// A sample's surfaces, and where its cloth is.
struct Scene {
    std::vector<RenderedSurface> surface;
    Eigen::AlignedBox2d cloth;
    std::string label;
};

class SceneMaker {
  public:
    explicit SceneMaker(const files::DatasetReader& reader)
        : reader_(reader),
          topology_(build_topology(reader.header().mesh.triangle)),
          rest_length_(simulate::edge_rest_lengths(reader.header().mesh, topology_)) {
        if (reader.header().body) body_ = skinned_body(*reader.header().body);
    }

    std::optional<Scene> scene(const SheetTile& tile) const {
        const files::DatasetHeader& header = reader_.header();
        const files::SampleRecord sample = reader_.read(tile.slot);
        if (!sample.cloth.allFinite()) return std::nullopt;
        Scene scene;
        scene.label = tile.label;
        if (body_ && header.embedding && sample.pose.allFinite() && sample.embedded.allFinite())
            scene.surface.push_back({body_->triangle, posed_as_stored(header, *body_, sample).position,
                                     std::vector<Color>(static_cast<size_t>(body_->rest_position.rows()), skin_tone)});
        scene.surface.push_back(
            {header.mesh.triangle, sample.cloth, stretch_colors(topology_, rest_length_, sample.cloth)});
        for (Eigen::Index v = 0; v < sample.cloth.rows(); ++v)
            scene.cloth.extend(Eigen::Vector2d(sample.cloth(v, 0), sample.cloth(v, 1)));
        return scene;
    }

  private:
    const files::DatasetReader& reader_;
    Topology topology_;
    Eigen::VectorXd rest_length_;
    std::optional<skin::Body> body_;
};

/// One view in which the cloth of all samples has its place, with room for head and hands around it.
FrontView common_view(const std::vector<Scene>& scene) {
    Eigen::AlignedBox2d box;
    for (const Scene& one : scene) box.extend(one.cloth);
    FrontView view;
    view.width = tile_width;
    view.height = tile_height;
    view.ground = {0.90, 0.91, 0.93};  // white cloth is seen against it
    view.centre = box.center();
    view.metres_per_pixel = 1.35 * std::max(box.sizes().x() / tile_width, box.sizes().y() / tile_height);
    return view;
}

void place(files::Picture& sheet, const files::Picture& tile, int left, int top) {
    for (int y = 0; y < tile.height; ++y)
        std::copy_n(tile.value.begin() + static_cast<std::ptrdiff_t>(3) * y * tile.width,
                    static_cast<std::ptrdiff_t>(3) * tile.width,
                    sheet.value.begin() + 3 * (static_cast<std::ptrdiff_t>(top + y) * sheet.width + left));
}

void draw_legend(files::Picture& sheet) {
    constexpr int left = 150, width = 160;
    write_text(sheet, gap, 16, "stretch of the cloth:");
    for (int i = 0; i < width; ++i) fill(sheet, left + i, 12, 1, 14, stretch_color(0.75 + 0.5 * i / (width - 1)));
    write_text(sheet, left - 8, 30, "0.75");
    write_text(sheet, left + width / 2 - 3, 30, "1");
    write_text(sheet, left + width - 12, 30, "1.25");
}

}  // namespace

files::Picture sample_sheet(const files::DatasetReader& reader, const std::vector<SheetTile>& tile) {
    const SceneMaker maker(reader);
    std::vector<Scene> scene;
    for (const SheetTile& one : tile)
        if (std::optional<Scene> made = maker.scene(one)) scene.push_back(std::move(*made));
    const int count = static_cast<int>(scene.size());
    const int wide = std::clamp(count, 2, columns), rows = (count + wide - 1) / wide;
    files::Picture sheet =
        blank_picture(gap + wide * (tile_width + gap), header_height + rows * (tile_height + label_height + gap));
    draw_legend(sheet);
    if (count == 0) return sheet;
    const FrontView view = common_view(scene);
    for (int i = 0; i < count; ++i) {
        const int left = gap + (i % wide) * (tile_width + gap);
        const int top = header_height + (i / wide) * (tile_height + label_height + gap);
        place(sheet, render(scene[i].surface, view), left, top);
        write_text(sheet, left + 6, top + tile_height + 5, scene[i].label);
    }
    return sheet;
}

}  // namespace toile::generate
