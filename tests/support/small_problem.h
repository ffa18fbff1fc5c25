#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "files/hdf5_file.h"

namespace toile::test {

inline constexpr int rows = 4, columns = 5, vertices = rows * columns;
inline constexpr size_t width = 3 * vertices;
inline constexpr double edge_length = 0.02;  // m

/// A grid of triangles at rest, its predictions and its targets.
struct SmallProblem {
    std::vector<int32_t> triangle;
    std::vector<double> rest, predicted, target;

    explicit SmallProblem(int samples, double noise = 0.004) {
        for (int i = 0; i < rows; ++i)
            for (int j = 0; j < columns; ++j)
                for (const double x : {j * edge_length, 0.0, i * edge_length}) rest.push_back(x);
        for (int i = 0; i + 1 < rows; ++i)
            for (int j = 0; j + 1 < columns; ++j) {
                const int a = i * columns + j, b = a + 1, c = a + columns, d = c + 1;
                for (const int v : {a, c, b, b, c, d}) triangle.push_back(v);
            }
        std::mt19937 random(7);
        std::uniform_real_distribution<double> shift(-1, 1);
        for (int n = 0; n < samples; ++n)
            for (size_t k = 0; k < width; ++k) {
                target.push_back(rest[k] + 0.3 * noise * shift(random));
                predicted.push_back(rest[k] + noise * shift(random));
            }
    }
    int64_t samples() const { return static_cast<int64_t>(predicted.size() / width); }
    void write(const std::string& path, bool with_target = true) const {
        files::Hdf5File file = files::Hdf5File::create(path);
        file.write("/mesh/triangle", triangle, {static_cast<int64_t>(triangle.size()) / 3, 3});
        file.write("/mesh/rest_position", rest, {vertices, 3});
        file.write("/samples/predicted", predicted, {samples(), vertices, 3});
        if (with_target) file.write("/samples/target", target, {samples(), vertices, 3});
        file.close();
    }
};

}  // namespace toile::test
