#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "prior/derivative_lanes.h"
#include "prior/newton_lanes.h"
#include "prior/one_sample.h"
#include "prior/quasistatic.h"
#include "prior/spring_graph.h"

namespace toile::prior {

struct Quasistatic::Impl {
    Impl(QuasistaticModel given, const QuasistaticOptions& chosen);

    QuasistaticModel model;
    QuasistaticOptions options;
    SpringGraph graph;
};

/// One of each for a thread, made when first needed.
struct Quasistatic::Workspace::Buffers {
    Buffers(const Quasistatic::Impl& owner, int thread_count);

    /// Number of samples; throws Error if the spans or this workspace do not fit.
    int check(const Quasistatic::Impl& owner, std::span<const double> predicted,
              const QuasistaticSolution& solution) const;

    const Quasistatic::Impl* prior;
    int threads;
    std::vector<std::unique_ptr<NewtonLanes<8>>> eight;
    std::vector<std::unique_ptr<NewtonLanes<1>>> one;
    std::vector<std::unique_ptr<NewtonLanes<1>>> last_resort;
    std::vector<std::unique_ptr<DerivativeLanes<8>>> derivative_eight;
    std::vector<std::unique_ptr<DerivativeLanes<1>>> derivative_one;
    std::unique_ptr<DerivativeLanes<1>> derivative_last_resort;
    std::vector<int> order;        ///< samples, those far from rest first
    std::vector<double> distance;  ///< of each sample from rest
    std::vector<int> hard;         ///< samples set aside for the last resort
};

/// The loops of the default method for W samples side by side.
template <int W>
std::unique_ptr<LinearSweeps<W>> fast_sweeps(const SpringGraph& graph) {
    if constexpr (W == 1)
        return std::make_unique<OneSampleSweeps>(graph);
    else
        return std::make_unique<SingleSweeps<W>>(graph);
}

/// Calls `task(slot)` on each of `threads` threads; on the caller's own alone without touching the heap.
void on_threads(int threads, const std::function<void(int)>& task);

}  // namespace toile::prior
