#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace toile::generate {

/// Makes the bytes of one index.
using MakeBytes = std::function<std::string(int index)>;
/// Runs once in each new worker process and returns what makes the bytes there.
using StartWorker = std::function<MakeBytes()>;

struct WorkerProcessOptions {
    std::uint64_t memory_limit = 0;       ///< bytes of writable memory the worker may map; 0: no limit
    std::vector<int> parents_descriptor;  ///< the worker closes these: they are the parent's alone
};

/// One frame a worker sent.
struct WorkerMessage {
    enum class Kind : std::uint32_t {
        started,         ///< `start` has returned
        begun,           ///< `index` is in work
        made,            ///< `bytes` of `index`
        error,           ///< toile::Error; `bytes` holds its texts, see throw_error; the worker ends
        other_exception  ///< `bytes` is its text; the worker ends
    };
    Kind kind;
    int index;
    std::string bytes;
};

/// A forked process that makes the bytes of one index after another and sends them over a socket. The parent must be
/// single-threaded.
///
/// The worker ignores SIGINT and SIGTERM, which a terminal or a batch system sends to the whole group: the parent
/// decides. It ends with its parent, however that ends. It never runs the parent's destructors. Where the kernel's
/// memory runs out it offers itself to be killed before the parent.
class WorkerProcess {
  public:
    /// Throws Error where the system gives no further process or descriptor.
    WorkerProcess(const StartWorker& start, const WorkerProcessOptions& options);
    ~WorkerProcess();  ///< kills the process and waits for its end
    WorkerProcess(const WorkerProcess&) = delete;
    WorkerProcess& operator=(const WorkerProcess&) = delete;

    int descriptor() const { return socket_; }  ///< to be polled for reading
    /// Asks for one more index; returns false where the worker no longer listens.
    bool ask(int index);
    /// Reads once, without blocking, and appends the frames that are complete; false once the worker has hung up.
    bool receive(std::vector<WorkerMessage>& message);
    /// Ends the process, if it has not yet, and returns its wait status.
    int end();

  private:
    void take_frames(std::vector<WorkerMessage>& message);

    pid_t process_ = -1;
    int socket_ = -1;
    int status_ = 0;
    std::string buffer_;
};

/// Throws the toile::Error that a worker sent.
[[noreturn]] void throw_error(const WorkerMessage& message);

/// Whether an allocation failed, or the kernel may have ended the process because its memory was used up: SIGKILL.
bool ran_out_of_memory(int wait_status);

/// "signal 11 (Segmentation fault)" or "exit status 3".
std::string describe_end(int wait_status);

}  // namespace toile::generate
