#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

namespace toile {

/// A fixed number of doubles, aligned to a cache line and so to eight lanes (cloth/lane.h); zero at first.
class LaneArray {
  public:
    LaneArray() = default;
    explicit LaneArray(std::size_t size)
        : data_(static_cast<double*>(::operator new(size * sizeof(double), alignment))), size_(size) {
        std::fill(data_.get(), data_.get() + size, 0.0);
    }

    double* data() { return data_.get(); }
    const double* data() const { return data_.get(); }
    std::size_t size() const { return size_; }
    double& operator[](std::size_t i) { return data_.get()[i]; }
    double operator[](std::size_t i) const { return data_.get()[i]; }

  private:
    static constexpr std::align_val_t alignment{64};
    struct Free {
        void operator()(double* p) const { ::operator delete(p, alignment); }
    };
    std::unique_ptr<double, Free> data_;
    std::size_t size_ = 0;
};

}  // namespace toile
