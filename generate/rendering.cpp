#include "generate/rendering.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloth/topology.h"

namespace toile::generate {
namespace {

constexpr int fineness = 3;  // rays along each side of a pixel

/// Colours and depths at `fineness` times the picture's resolution.
struct Canvas {
    Canvas(int w, int h, const Color& ground)
        : width(w),
          height(h),
          color(static_cast<size_t>(w) * h, ground),
          depth(static_cast<size_t>(w) * h, -std::numeric_limits<double>::infinity()) {}
    int width, height;
    std::vector<Color> color;
    std::vector<double> depth;
};

/// How bright a surface is that faces along `normal`, whichever side is seen.
double brightness(const Eigen::Vector3d& normal) {
    static const Eigen::Vector3d light = Eigen::Vector3d(0.35, 0.55, 0.76).normalized();
    const Eigen::Vector3d towards = normal.z() < 0 ? Eigen::Vector3d(-normal) : normal;
    return 0.38 + 0.62 * std::max(towards.dot(light), 0.0);
}

/// Corners of one triangle on the canvas: x, y and depth.
struct Corners {
    std::array<Eigen::Vector3d, 3> at;
    std::array<Color, 3> color;
};

void draw(Canvas& canvas, const Corners& c) {
    const auto [a, b, d] = c.at;
    const double area = (b.x() - a.x()) * (d.y() - a.y()) - (d.x() - a.x()) * (b.y() - a.y());
    if (!(std::abs(area) > 1e-12)) return;
    const auto low = [](double v) { return static_cast<int>(std::ceil(std::max(v, 0.0))); };
    const int left = low(std::min({a.x(), b.x(), d.x()})), top = low(std::min({a.y(), b.y(), d.y()}));
    const double right = std::min<double>(std::max({a.x(), b.x(), d.x()}), canvas.width - 1);
    const double bottom = std::min<double>(std::max({a.y(), b.y(), d.y()}), canvas.height - 1);
    for (int y = top; y <= bottom; ++y)
        for (int x = left; x <= right; ++x) {
            const double v = ((x - a.x()) * (d.y() - a.y()) - (d.x() - a.x()) * (y - a.y())) / area;
            const double w = ((b.x() - a.x()) * (y - a.y()) - (x - a.x()) * (b.y() - a.y())) / area;
            const double u = 1 - v - w;
            if (u < 0 || v < 0 || w < 0) continue;
            const double depth = u * a.z() + v * b.z() + w * d.z();
            const size_t pixel = static_cast<size_t>(y) * canvas.width + x;
            if (depth <= canvas.depth[pixel]) continue;
            canvas.depth[pixel] = depth;
            for (int k = 0; k < 3; ++k)
                canvas.color[pixel][k] = u * c.color[0][k] + v * c.color[1][k] + w * c.color[2][k];
        }
}

void draw(Canvas& canvas, const RenderedSurface& surface, const FrontView& view) {
    const Positions normal = vertex_normals(surface.triangle, surface.position);
    const double scale = fineness / view.metres_per_pixel;
    const Eigen::Index vertices = surface.position.rows();
    std::vector<Eigen::Vector3d> at(static_cast<size_t>(vertices));
    std::vector<Color> lit(static_cast<size_t>(vertices));
    for (Eigen::Index v = 0; v < vertices; ++v) {
        at[v] = {0.5 * canvas.width + scale * (surface.position(v, 0) - view.centre.x()),
                 0.5 * canvas.height - scale * (surface.position(v, 1) - view.centre.y()), surface.position(v, 2)};
        const double light = brightness(normal.row(v).transpose());
        for (int k = 0; k < 3; ++k) lit[v][k] = std::min(light * surface.color[v][k], 1.0);
    }
    for (Eigen::Index f = 0; f < surface.triangle.rows(); ++f) {
        const auto t = surface.triangle.row(f);
        draw(canvas, {{at[t[0]], at[t[1]], at[t[2]]}, {lit[t[0]], lit[t[1]], lit[t[2]]}});
    }
}

}  // namespace

files::Picture render(const std::vector<RenderedSurface>& surface, const FrontView& view) {
    Canvas canvas(fineness * view.width, fineness * view.height, view.ground);
    for (const RenderedSurface& one : surface) draw(canvas, one, view);
    files::Picture picture = blank_picture(view.width, view.height);
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
            Color mean{0, 0, 0};
            for (int i = 0; i < fineness * fineness; ++i) {
                const size_t row = static_cast<size_t>(fineness) * y + i / fineness;
                const Color& one = canvas.color[row * canvas.width + static_cast<size_t>(fineness) * x + i % fineness];
                for (int k = 0; k < 3; ++k) mean[k] += one[k] / (fineness * fineness);
            }
            fill(picture, x, y, 1, 1, mean);
        }
    return picture;
}

}  // namespace toile::generate
