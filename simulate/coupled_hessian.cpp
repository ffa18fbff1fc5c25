#include "simulate/coupled_hessian.h"

#include <algorithm>

namespace toile::simulate {
namespace {

/// A graph that has served for this many factorisations is worth an ordering of its own, where the cloth's has this
/// many times the fill.
constexpr int uses_worth_ordering = 8;
constexpr double fill_worth_ordering = 1.25;

using Coupling = std::pair<int, int>;

/// Pairs of vertices across each stencil; what lies within a triangle or an edge is on the cloth's own graph.
void append_couplings(const std::vector<std::array<int, 4>>& stencils, std::vector<Coupling>& couplings) {
    for (const auto& point : stencils)
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < i; ++j)
                couplings.emplace_back(std::max(point[i], point[j]), std::min(point[i], point[j]));
}

void sort_unique(std::vector<Coupling>& couplings) {
    std::sort(couplings.begin(), couplings.end());
    couplings.erase(std::unique(couplings.begin(), couplings.end()), couplings.end());
}

}  // namespace

CoupledHessian::CoupledHessian(std::shared_ptr<const BlockSymbolic> own) : own_(std::move(own)) {}

bool CoupledHessian::holds(const std::vector<std::array<int, 4>>& stencils) const {
    for (const auto& point : stencils)
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < i; ++j)
                if (!std::binary_search(coupling_.begin(), coupling_.end(),
                                        Coupling(std::max(point[i], point[j]), std::min(point[i], point[j]))))
                    return false;
    return true;
}

void CoupledHessian::couple(const std::vector<std::array<int, 4>>& needed,
                            const std::vector<std::array<int, 4>>& likely) {
    if (needed.empty()) {
        coupled_.reset();
        coupled_cholesky_.reset();
        coupling_.clear();
    } else if (!coupled_ || !holds(needed)) {
        coupling_.clear();
        append_couplings(needed, coupling_);
        append_couplings(likely, coupling_);
        sort_unique(coupling_);
        rebuild(false);
    } else if (!reordered_ && uses_ >= uses_worth_ordering &&
               static_cast<double>(coupled_->symbolic().factor_nonzeros()) >
                   fill_worth_ordering * static_cast<double>(own_.symbolic().factor_nonzeros())) {
        rebuild(true);
    }
    own_.set_zero();
}

void CoupledHessian::rebuild(bool reorder) {
    const BlockSymbolic& own = own_.symbolic();
    std::vector<Coupling> pairs = own.pair();
    pairs.insert(pairs.end(), coupling_.begin(), coupling_.end());
    auto symbolic = reorder ? std::make_shared<const BlockSymbolic>(own.vertex_count(), std::move(pairs))
                            : std::make_shared<const BlockSymbolic>(own, std::move(pairs));
    coupled_ = std::make_unique<BlockValues>(symbolic);
    coupled_cholesky_ = std::make_unique<LaneCholesky<1>>(symbolic);
    slot_.resize(own.slot_count());
    for (int v = 0; v < own.vertex_count(); ++v) slot_[v] = v;
    // Both lists of pairs are sorted alike.
    size_t at = 0;
    for (size_t k = 0; k < own.pair().size(); ++k) {
        while (symbolic->pair()[at] != own.pair()[k]) ++at;
        slot_[own.vertex_count() + k] = own.vertex_count() + static_cast<int>(at);
    }
    uses_ = 0;
    reordered_ = reorder;
}

void CoupledHessian::finish() {
    if (!coupled_) return;
    coupled_->set_zero();
    for (int slot = 0; slot < own_.symbolic().slot_count(); ++slot)
        std::copy_n(own_.block(slot), 9, coupled_->block(slot_[slot]));
}

bool CoupledHessian::factor_and_solve(double* x) {
    if (coupled_) {
        ++uses_;
        return coupled_cholesky_->factor_and_solve(coupled_->data(), x).all();
    }
    if (!own_cholesky_) own_cholesky_ = std::make_unique<LaneCholesky<1>>(own_.shared_symbolic());
    return own_cholesky_->factor_and_solve(own_.data(), x).all();
}

void CoupledHessian::solve(double* x) const {
    (coupled_ ? coupled_cholesky_ : own_cholesky_)->solve(x);
}

}  // namespace toile::simulate
