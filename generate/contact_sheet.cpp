#include "generate/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "generate/drawing.h"

namespace toile::generate {
namespace {

constexpr int gap = 12;     // between tiles
constexpr int header = 48;  // above the tiles
constexpr int label_width = 84;

/// The part of a layer that the pattern covers, in pixels.
struct Crop {
    int column = 0, row = 0, width = 0, height = 0;
};

Crop covered(const files::DatasetImage& image, int layer) {
    int left = image.size, right = -1, top = image.size, bottom = -1;
    for (int row = 0; row < image.size; ++row) {
        for (int column = 0; column < image.size; ++column) {
            if (!image.mask[(static_cast<size_t>(layer) * image.size + row) * image.size + column]) continue;
            left = std::min(left, column);
            right = std::max(right, column);
            top = std::min(top, row);
            bottom = std::max(bottom, row);
        }
    }
    if (right < 0) return {};
    return {left, top, right - left + 1, bottom - top + 1};
}

/// A round number of millimetres that all but a few covered pixels of a component stay below.
double scale_of(const files::DatasetImage& image, const std::vector<SheetRow>& row, int component) {
    const size_t area = static_cast<size_t>(image.size) * image.size;
    std::vector<float> size;
    for (const SheetRow& one : row)
        for (size_t i = 0; i < image.mask.size(); ++i)
            if (image.mask[i]) {
                const float value = one.image[(3 * (i / area) + component) * area + i % area];
                if (std::isfinite(value)) size.push_back(std::abs(value));
            }
    if (size.empty()) return 0.001;
    const auto place = size.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(size.size() - 1));
    std::nth_element(size.begin(), place, size.end());
    const double wanted = std::max<double>(*place, 1e-4);
    const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
    for (const double step : {1.0, 1.5, 2.0, 3.0, 5.0, 7.0})
        if (step * decade >= wanted) return step * decade;
    return 10 * decade;
}

/// The places of the tiles on the sheet.
struct Plan {
    std::vector<Crop> crop;  ///< of each layer
    int zoom = 1;
    int tile_height = 0;
    int component_width = 0;
};

Plan make_plan(const files::DatasetImage& image) {
    Plan plan;
    plan.zoom = std::max(1, 160 / image.size);
    for (int layer = 0; layer < image.layers; ++layer) {
        plan.crop.push_back(covered(image, layer));
        plan.tile_height = std::max(plan.tile_height, plan.zoom * plan.crop.back().height);
        plan.component_width += plan.zoom * plan.crop.back().width + gap;
    }
    return plan;
}

void draw_tiles(files::Picture& picture, const files::DatasetImage& image, const Plan& plan, const SheetRow& row,
                int component, double scale, int x, int y) {
    const size_t area = static_cast<size_t>(image.size) * image.size;
    for (int layer = 0; layer < image.layers; ++layer) {
        const Crop& crop = plan.crop[layer];
        for (int j = 0; j < crop.height; ++j) {
            for (int i = 0; i < crop.width; ++i) {
                const size_t pixel = static_cast<size_t>(crop.row + j) * image.size + crop.column + i;
                if (!image.mask[layer * area + pixel]) continue;
                const double value = row.image[(3 * layer + component) * area + pixel];
                const Color color = std::isfinite(value) ? diverging(value / scale) : Color{0, 0, 0};
                fill(picture, x + plan.zoom * i, y + plan.zoom * j, plan.zoom, plan.zoom, color);
            }
        }
        x += plan.zoom * crop.width + gap;
    }
}

/// Name, bar and bounds of a component's scale.
void draw_scale(files::Picture& picture, int component, double scale, int x) {
    static const char* name[] = {"du (along u)", "dv (along v)", "dn (outwards)"};
    char text[64];
    std::snprintf(text, sizeof text, "%s, mm", name[component]);
    write_text(picture, x, 8, text);
    std::snprintf(text, sizeof text, "%g", -1000 * scale);
    write_text(picture, x, 26, text);
    constexpr int bar = 96, bar_left = 36;
    for (int i = 0; i < bar; ++i) fill(picture, x + bar_left + i, 24, 1, 12, diverging(2.0 * i / (bar - 1) - 1));
    std::snprintf(text, sizeof text, "%g", 1000 * scale);
    write_text(picture, x + bar_left + bar + 6, 26, text);
}

}  // namespace

files::Picture contact_sheet(const files::DatasetImage& image, const std::vector<SheetRow>& row) {
    const Plan plan = make_plan(image);
    const int component_step = std::max(plan.component_width + gap, 200);
    files::Picture picture = blank_picture(label_width + 3 * component_step,
                                           header + static_cast<int>(row.size()) * (plan.tile_height + gap) + gap);
    for (int component = 0; component < 3; ++component) {
        const double scale = scale_of(image, row, component);
        const int x = label_width + component * component_step;
        draw_scale(picture, component, scale, x);
        for (size_t i = 0; i < row.size(); ++i)
            draw_tiles(picture, image, plan, row[i], component, scale, x,
                       header + static_cast<int>(i) * (plan.tile_height + gap));
    }
    for (size_t i = 0; i < row.size(); ++i)
        write_text(picture, 8, header + static_cast<int>(i) * (plan.tile_height + gap), row[i].label);
    return picture;
}

}  // namespace toile::generate
