#include "cloth/lane_cholesky.h"

#include <cstring>
#include <vector>

#include "cloth/lane_array.h"
#include "cloth/lane_panel.h"
#include "cloth/lane_solve.h"

namespace toile {
namespace {

using panel::EightSamples;
using panel::OneSample;
using panel::SolveTask;
using panel::UpdateTask;

/// One instruction set's loops. Choosing among tables instead of letting the loader choose (TOILE_LANE_KERNEL) gives
/// each set its own register width and tile.
struct Kernels {
    void (*fill)(const BlockSymbolic::Entry* entry, int count, const double* blocks, double* panel, int width);
    void (*update)(const UpdateTask&);
    unsigned (*factor)(double* panel, int width, int height);
    void (*forward)(const SolveTask&, double* x);
    void (*backward)(const SolveTask&, double* x);
};

#define TOILE_KERNELS(NAME, TARGET, SAMPLES, ROWS, SOLVE, SOLVE_ROWS, SOLVE_COLUMNS)                                 \
    namespace NAME {                                                                                                 \
    TARGET void fill(const BlockSymbolic::Entry* entry, int count, const double* blocks, double* panel, int width) { \
        panel::fill_panel<SAMPLES>(entry, count, blocks, panel, width);                                              \
    }                                                                                                                \
    TARGET void update(const UpdateTask& task) {                                                                     \
        panel::update_panel<SAMPLES, ROWS>(task);                                                                    \
    }                                                                                                                \
    TARGET unsigned factor(double* panel, int width, int height) {                                                   \
        return lane_bits(panel::factor_panel<SAMPLES, ROWS>(panel, width, height));                                  \
    }                                                                                                                \
    TARGET void forward(const SolveTask& t, double* x) {                                                             \
        panel::solve_forward<SOLVE, SOLVE_ROWS>(t, x);                                                               \
    }                                                                                                                \
    TARGET void backward(const SolveTask& t, double* x) {                                                            \
        panel::solve_backward<SOLVE, SOLVE_COLUMNS>(t, x);                                                           \
    }                                                                                                                \
    constexpr Kernels table{fill, update, factor, forward, backward};                                                \
    }

#if defined(__x86_64__)
#define TOILE_AVX512 __attribute__((target("arch=x86-64-v4")))
#define TOILE_AVX2 __attribute__((target("arch=x86-64-v3")))
TOILE_KERNELS(one_avx512, TOILE_AVX512, panel::OneSampleInPairs, 8, panel::SolveOneSample, 4, 12)
TOILE_KERNELS(one_avx2, TOILE_AVX2, OneSample, 3, panel::SolveOneSample, 4, 6)
TOILE_KERNELS(eight_avx512, TOILE_AVX512, EightSamples<Lane8>, 2, panel::SolveEightSamples<Lane8>, 2, 6)
TOILE_KERNELS(eight_avx2, TOILE_AVX2, EightSamples<panel::Four>, 1, panel::SolveEightSamples<panel::Four>, 2, 6)
#endif
TOILE_KERNELS(one_plain, , panel::OneSampleInPieces, 2, panel::SolveOneSample, 2, 3)
TOILE_KERNELS(eight_plain, , EightSamples<panel::Two>, 1, panel::SolveEightSamples<panel::Two>, 2, 6)

template <int W>
const Kernels& pick_kernels() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("x86-64-v4")) return W == 1 ? one_avx512::table : eight_avx512::table;
    if (__builtin_cpu_supports("x86-64-v3")) return W == 1 ? one_avx2::table : eight_avx2::table;
#endif
    return W == 1 ? one_plain::table : eight_plain::table;
}

#if defined(__x86_64__)
#define TOILE_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define TOILE_CLONES
#endif
TOILE_CLONES void forward_eight_sides(const SolveTask& t, double* x) {
    panel::solve_forward<panel::SolveManySides<Lane8>, 2>(t, x);
}
TOILE_CLONES void backward_eight_sides(const SolveTask& t, double* x) {
    panel::solve_backward<panel::SolveManySides<Lane8>, 6>(t, x);
}
void forward_one_side(const SolveTask& t, double* x) {
    panel::solve_forward<panel::SolveManySides<double>, 2>(t, x);
}
void backward_one_side(const SolveTask& t, double* x) {
    panel::solve_backward<panel::SolveManySides<double>, 6>(t, x);
}

/// Doubles of a scalar column of a block.
template <int W>
constexpr std::size_t column_size = W == 1 ? OneSample::column : EightSamples<Lane8>::column;

}  // namespace

template <int W>
struct LaneCholesky<W>::Storage {
    const Kernels& kernels = pick_kernels<W>();
    std::vector<std::size_t> panel_start;  // by supernode, into panel
    LaneArray panel;

    explicit Storage(const BlockSymbolic& symbolic) {
        std::size_t size = 0;
        for (const auto& s : symbolic.supernode()) {
            panel_start.push_back(size);
            size += static_cast<std::size_t>(s.height()) * s.width() * 3 * column_size<W>;
        }
        panel = LaneArray(size);
    }

    SolveTask solve_task(const BlockSymbolic& symbolic, std::size_t supernode) const {
        const auto& s = symbolic.supernode()[supernode];
        return {panel.data() + panel_start[supernode], s.width(), s.height(),
                symbolic.row_vertex().data() + s.row_begin, W};
    }
};

template <int W>
LaneCholesky<W>::LaneCholesky(std::shared_ptr<const BlockSymbolic> symbolic)
    : symbolic_(std::move(symbolic)), storage_(std::make_unique<Storage>(*symbolic_)) {}
template <int W>
LaneCholesky<W>::~LaneCholesky() = default;
template <int W>
LaneCholesky<W>::LaneCholesky(LaneCholesky&&) noexcept = default;
template <int W>
LaneCholesky<W>& LaneCholesky<W>::operator=(LaneCholesky&&) noexcept = default;

template <int W>
std::bitset<W> LaneCholesky<W>::factor(const double* blocks) {
    return factor_forward(blocks, nullptr);
}

template <int W>
std::bitset<W> LaneCholesky<W>::factor_and_solve(const double* blocks, double* x) {
    const std::bitset<W> good = factor_forward(blocks, x);
    solve_backward(x);
    return good;
}

template <int W>
std::bitset<W> LaneCholesky<W>::factor_forward(const double* blocks, double* x) {
    const BlockSymbolic& symbolic = *symbolic_;
    Storage& storage = *storage_;
    unsigned good = (1u << W) - 1;
    for (std::size_t j = 0; j < symbolic.supernode().size(); ++j) {
        const auto& target = symbolic.supernode()[j];
        double* const panel = storage.panel.data() + storage.panel_start[j];
        std::memset(panel, 0, sizeof(double) * 3 * column_size<W> * target.width() * target.height());
        storage.kernels.fill(symbolic.entry().data() + target.entry_begin, target.entry_end - target.entry_begin,
                             blocks, panel, target.width());
        for (int u = target.update_begin; u < target.update_end; ++u) {
            const auto& update = symbolic.update()[u];
            const auto& source = symbolic.supernode()[update.descendant];
            storage.kernels.update({.source = storage.panel.data() + storage.panel_start[update.descendant],
                                    .source_width = source.width(),
                                    .first = update.first,
                                    .last = update.last,
                                    .height = source.height(),
                                    .target = symbolic.target().data() + update.target,
                                    .panel = panel,
                                    .width = target.width()});
        }
        good &= storage.kernels.factor(panel, target.width(), target.height());
        if (x) storage.kernels.forward(storage.solve_task(symbolic, j), x);
    }
    return std::bitset<W>(good);
}

template <int W>
void LaneCholesky<W>::solve(double* x) const {
    for (std::size_t s = 0; s < symbolic_->supernode().size(); ++s)
        storage_->kernels.forward(storage_->solve_task(*symbolic_, s), x);
    solve_backward(x);
}

template <int W>
void LaneCholesky<W>::solve_backward(double* x) const {
    for (std::size_t s = symbolic_->supernode().size(); s-- > 0;)
        storage_->kernels.backward(storage_->solve_task(*symbolic_, s), x);
}

template <int W>
void LaneCholesky<W>::solve_many(double* x, int count) const requires(W == 1) {
    const std::size_t supernodes = symbolic_->supernode().size();
    for (int side = 0; side < count;) {
        const bool eight = side + 8 <= count;
        const auto forward = eight ? forward_eight_sides : forward_one_side;
        const auto backward = eight ? backward_eight_sides : backward_one_side;
        const auto task = [&](std::size_t s) {
            SolveTask t = storage_->solve_task(*symbolic_, s);
            t.sides = count;
            return t;
        };
        for (std::size_t s = 0; s < supernodes; ++s) forward(task(s), x + side);
        for (std::size_t s = supernodes; s-- > 0;) backward(task(s), x + side);
        side += eight ? 8 : 1;
    }
}

template <int W>
std::size_t LaneCholesky<W>::storage_bytes() const {
    return storage_->panel.size() * sizeof(double) + storage_->panel_start.size() * sizeof(std::size_t);
}

template class LaneCholesky<1>;
template class LaneCholesky<8>;

}  // namespace toile
