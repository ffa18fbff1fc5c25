#include "generate/worker_pool.h"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <deque>
#include <memory>
#include <stdexcept>
#include <utility>

#include "cloth/error.h"
#include "generate/ordered_work.h"

namespace toile::generate {
namespace {

using Clock = std::chrono::steady_clock;
using Kind = WorkerMessage::Kind;

constexpr auto idle_period = std::chrono::seconds(1);
constexpr int poll_milliseconds = 200;  // how soon an interrupt is seen that came between the check and the poll

/// Ended processes can be waited for, even where whoever started this program ignores its children.
class WaitableChildren {
  public:
    WaitableChildren() : before_(std::signal(SIGCHLD, SIG_DFL)) {}
    ~WaitableChildren() { std::signal(SIGCHLD, before_); }
    WaitableChildren(const WaitableChildren&) = delete;
    WaitableChildren& operator=(const WaitableChildren&) = delete;

  private:
    void (*before_)(int);
};

/// Which try an index is at.
enum class Try { first, again, again_alone };

struct Item {
    int index;
    Try which;
};

struct Worker {
    std::unique_ptr<WorkerProcess> process;
    std::deque<Item> given;  ///< asked for and not yet made, in order
    bool started = false;
    bool fresh = true;   ///< nothing was asked of it yet
    bool begun = false;  ///< the first of `given` is in work
    std::optional<WorkerMessage> last_words;
};

/// How a worker ended.
struct Death {
    WorkerFailure failure;
    std::string detail;
};

Death death_of(Worker& worker) {
    const int status = worker.process->end();
    if (worker.last_words) return {WorkerFailure::crashed, worker.last_words->bytes};
    return {ran_out_of_memory(status) ? WorkerFailure::out_of_memory : WorkerFailure::crashed, describe_end(status)};
}

class Pool {
  public:
    Pool(const std::vector<int>& index, const WorkerPoolOptions& options, const StartWorker& start,
         const std::function<void(WorkResult)>& take)
        : options_(options), start_(start), take_(take), index_(index) {}

    bool finished() const { return !waiting() && !busy(); }

    /// Keeps as many workers as there is work for, and enough new ones for what is tried again.
    void supply() {
        const size_t most = static_cast<size_t>(std::max(options_.workers, 1));
        while (worker_.size() < most &&
               (worker_.size() < under_way() + waiting() || fresh_workers() < again_.size() + alone_.size()))
            add_worker();
        hand_out();
    }

    /// Waits for what workers send, for a short time at most, and takes it.
    void serve() {
        std::vector<pollfd> event;
        for (const Worker& worker : worker_) event.push_back({worker.process->descriptor(), POLLIN, 0});
        if (::poll(event.data(), event.size(), poll_milliseconds) <= 0) return;
        for (size_t w = event.size(); w-- > 0;)  // from the back: a worker that ended is taken out
            if (event[w].revents != 0) serve(w);
    }

  private:
    size_t waiting() const { return index_.size() - next_ + returned_.size() + again_.size() + alone_.size(); }
    size_t under_way() const {
        size_t count = 0;
        for (const Worker& worker : worker_) count += worker.given.empty() ? 0 : 1;
        return count;
    }
    size_t fresh_workers() const {
        return static_cast<size_t>(
            std::count_if(worker_.begin(), worker_.end(), [](const Worker& worker) { return worker.fresh; }));
    }
    bool busy() const { return under_way() > 0; }

    void add_worker() {
        WorkerProcessOptions process{options_.memory_limit, options_.parents_descriptor};
        for (const Worker& other : worker_) process.parents_descriptor.push_back(other.process->descriptor());
        worker_.push_back({std::make_unique<WorkerProcess>(start_, process), {}, false, true, false, {}});
    }

    void hand_out() {
        if (!alone_.empty()) {
            if (!busy()) give_fresh(alone_);
            return;
        }
        for (const Worker& worker : worker_)
            if (!worker.given.empty() && worker.given.front().which == Try::again_alone) return;
        while (!again_.empty() && give_fresh(again_)) {
        }
        give_each(0);
        // One is asked for ahead, so that a worker has work while the parent writes; not the last ones, which another
        // worker may come to sooner.
        if (waiting() > worker_.size()) give_each(1);
    }

    bool give_fresh(std::deque<Item>& from) {
        for (Worker& worker : worker_) {
            if (!worker.started || !worker.fresh) continue;
            const Item item = from.front();
            from.pop_front();
            give(worker, item);
            return true;
        }
        return false;
    }

    /// Gives the next index to each worker that was given `already` others.
    void give_each(size_t already) {
        for (Worker& worker : worker_) {
            if (!worker.started || worker.given.size() != already) continue;
            if (worker.fresh && !again_.empty()) continue;
            if (!returned_.empty()) {
                const Item item = returned_.front();
                returned_.pop_front();
                give(worker, item);
            } else if (next_ < index_.size()) {
                give(worker, {index_[next_++], Try::first});
            }
        }
    }

    /// A worker that no longer listens is found by its hanging up, and what it was given comes back.
    void give(Worker& worker, Item item) {
        worker.fresh = false;
        worker.given.push_back(item);
        worker.process->ask(item.index);
    }

    void serve(size_t w) {
        std::vector<WorkerMessage> message;
        const bool open = worker_[w].process->receive(message);
        for (WorkerMessage& one : message) handle(worker_[w], std::move(one));
        if (!open) bury(w);
    }

    void handle(Worker& worker, WorkerMessage message) {
        switch (message.kind) {
            case Kind::started:
                worker.started = true;
                failed_starts_ = 0;
                return;
            case Kind::begun:
                worker.begun = true;
                return;
            case Kind::made:
                worker.begun = false;
                worker.given.pop_front();
                take_({message.index, std::move(message.bytes), {}, {}});
                return;
            case Kind::error:
                throw_error(message);
            case Kind::other_exception:
                worker.last_words = std::move(message);
                return;
        }
    }

    void bury(size_t w) {
        Worker worker = std::move(worker_[w]);
        worker_.erase(worker_.begin() + static_cast<std::ptrdiff_t>(w));
        const Death death = death_of(worker);
        if (!worker.started && ++failed_starts_ == 2) fail_to_start(death);
        std::optional<Item> blamed;
        if (worker.begun) {
            blamed = worker.given.front();
            worker.given.pop_front();
        }
        for (auto item = worker.given.rbegin(); item != worker.given.rend(); ++item)
            queue_of(item->which).push_front(*item);
        if (blamed) blame(*blamed, death);
    }

    std::deque<Item>& queue_of(Try which) {
        return which == Try::first ? returned_ : which == Try::again ? again_ : alone_;
    }

    void blame(Item item, const Death& death) {
        if (item.which != Try::first) {
            take_({item.index, {}, death.failure, death.detail});
            return;
        }
        item.which = death.failure == WorkerFailure::out_of_memory ? Try::again_alone : Try::again;
        queue_of(item.which).push_back(item);
    }

    [[noreturn]] static void fail_to_start(const Death& death) {
        if (death.failure == WorkerFailure::out_of_memory)
            throw Error("worker processes run out of memory before their first sample: " + death.detail, {},
                        "give each more memory, or try fewer --jobs");
        throw std::runtime_error("worker processes die before their first sample: " + death.detail);
    }

    const WorkerPoolOptions& options_;
    const StartWorker& start_;
    const std::function<void(WorkResult)>& take_;
    const std::vector<int>& index_;
    size_t next_ = 0;            ///< of `index_`
    std::deque<Item> returned_;  ///< given to a worker that ended before it began them
    std::deque<Item> again_;     ///< for a new process
    std::deque<Item> alone_;     ///< for a new process, with nothing else in work
    std::vector<Worker> worker_;
    int failed_starts_ = 0;  ///< in a row
};

}  // namespace

void run_in_workers(const std::vector<int>& index, const WorkerPoolOptions& options, const StartWorker& start,
                    const std::function<void(WorkResult)>& take, const std::function<void()>& idle) {
    const WaitableChildren waitable;
    Pool pool(index, options, start, take);
    Clock::time_point idled = Clock::now();
    while (!pool.finished()) {
        if (options.interrupted && *options.interrupted) throw Interrupted("interrupted");
        pool.supply();
        pool.serve();
        if (idle && Clock::now() - idled >= idle_period) {
            idle();
            idled = Clock::now();
        }
    }
}

}  // namespace toile::generate
