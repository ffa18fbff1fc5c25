#include "cloth/block_values.h"

namespace toile {

void BlockValues::fix(const std::vector<bool>& fixed) {
    const int vertices = symbolic_->vertex_count();
    for (int v = 0; v < vertices; ++v) {
        if (!fixed[v]) continue;
        std::fill(block(v), block(v) + 9, 0.0);
        add_identity(v, 1.0);
    }
    int slot = vertices;
    for (const auto& [i, j] : symbolic_->pair()) {
        if (fixed[i] || fixed[j]) std::fill(block(slot), block(slot) + 9, 0.0);
        ++slot;
    }
}

void BlockValues::multiply(const double* x, double* y) const {
    const int vertices = symbolic_->vertex_count();
    const double* value = value_.data();
    for (int v = 0; v < vertices; ++v, value += 9) {
        const double *in = x + 3 * v, *b = value;
        double* out = y + 3 * v;
        for (int r = 0; r < 3; ++r) out[r] = b[3 * r] * in[0] + b[3 * r + 1] * in[1] + b[3 * r + 2] * in[2];
    }
    for (const auto& [i, j] : symbolic_->pair()) {
        const double *from_i = x + 3 * i, *from_j = x + 3 * j, *b = value;
        double *to_i = y + 3 * i, *to_j = y + 3 * j;
        for (int r = 0; r < 3; ++r) {
            to_i[r] += b[3 * r] * from_j[0] + b[3 * r + 1] * from_j[1] + b[3 * r + 2] * from_j[2];
            to_j[r] += b[r] * from_i[0] + b[3 + r] * from_i[1] + b[6 + r] * from_i[2];
        }
        value += 9;
    }
}

}  // namespace toile
