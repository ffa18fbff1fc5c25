#include "generate/ordered_work.h"

#include <condition_variable>
#include <map>
#include <mutex>

#include "cloth/parallel.h"

namespace toile::generate {
namespace {

/// The window of records that are made but not yet taken.
class Window {
  public:
    explicit Window(int width) : width_(width) {}

    /// Waits until `index` is within the window; false once the work has failed elsewhere.
    bool enter(int index) {
        std::unique_lock lock(mutex_);
        moved_.wait(lock, [&] { return failed_ || index < next_ + width_; });
        return !failed_;
    }

    void put(int index, files::SampleRecord record, const std::function<void(int, files::SampleRecord)>& take) {
        const std::lock_guard lock(mutex_);
        waiting_.emplace(index, std::move(record));
        for (auto first = waiting_.find(next_); first != waiting_.end(); first = waiting_.find(next_)) {
            take(next_, std::move(first->second));
            waiting_.erase(first);
            ++next_;
        }
        moved_.notify_all();
    }

    void fail() {
        const std::lock_guard lock(mutex_);
        failed_ = true;
        moved_.notify_all();
    }

  private:
    const int width_;
    std::mutex mutex_;
    std::condition_variable moved_;
    std::map<int, files::SampleRecord> waiting_;
    int next_ = 0;
    bool failed_ = false;
};

}  // namespace

void make_in_order(int count, int jobs, const std::function<files::SampleRecord(int)>& make,
                   const std::function<void(int, files::SampleRecord)>& take, const std::atomic<bool>* interrupted) {
    Window window(4 * jobs);
    parallel_for(count, jobs, [&](int, int index) {
        try {
            if (interrupted && *interrupted) throw Interrupted();
            if (window.enter(index)) window.put(index, make(index), take);
        } catch (...) {
            window.fail();
            throw;
        }
    });
}

}  // namespace toile::generate
