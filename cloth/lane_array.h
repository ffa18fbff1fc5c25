#pragma once

#include <cstddef>
#include <memory>
#include <new>

namespace toile {

/// A fixed number of doubles, aligned to a cache line and so to eight lanes (cloth/lane.h); zero at first. A large one
/// asks the system for huge pages.
class LaneArray {
  public:
    LaneArray() = default;
    explicit LaneArray(std::size_t size);

    double* data() { return data_.get(); }
    const double* data() const { return data_.get(); }
    std::size_t size() const { return size_; }
    double& operator[](std::size_t i) { return data_.get()[i]; }
    double operator[](std::size_t i) const { return data_.get()[i]; }

  private:
    struct Free {
        std::align_val_t alignment;
        void operator()(double* p) const { ::operator delete(p, alignment); }
    };
    std::unique_ptr<double, Free> data_;
    std::size_t size_ = 0;
};

}  // namespace toile
