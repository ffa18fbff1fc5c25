#include "cloth/vertex_ordering.h"

#include <cholmod.h>

#include <algorithm>
#include <numeric>

#include "cloth/error.h"

namespace toile {

std::vector<int> order_vertices(int vertex_count, const std::vector<std::pair<int, int>>& pairs) {
    std::vector<int> order(vertex_count);
    std::iota(order.begin(), order.end(), 0);
    if (pairs.empty()) return order;

    std::vector<int> column_start(vertex_count + 1, 0), row(pairs.size());
    for (const auto& pair : pairs) ++column_start[pair.second + 1];
    std::partial_sum(column_start.begin(), column_start.end(), column_start.begin());
    std::vector<int> next(column_start.begin(), column_start.end() - 1);
    for (const auto& [i, j] : pairs) row[next[j]++] = i;

    cholmod_sparse pattern{};
    pattern.nrow = pattern.ncol = static_cast<size_t>(vertex_count);
    pattern.nzmax = row.size();
    pattern.p = column_start.data();
    pattern.i = row.data();
    pattern.stype = -1;
    pattern.itype = CHOLMOD_INT;
    pattern.xtype = CHOLMOD_PATTERN;
    pattern.packed = 1;
    cholmod_common common;
    cholmod_start(&common);
    common.print = 0;
    const bool ordered = cholmod_amd(&pattern, nullptr, 0, order.data(), &common);
    cholmod_finish(&common);
    if (!ordered) throw Error("the matrix could not be ordered for Cholesky: out of memory");
    return order;
}

}  // namespace toile
