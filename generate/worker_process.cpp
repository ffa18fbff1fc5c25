#include "generate/worker_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <new>
#include <utility>

#include "cloth/error.h"

namespace toile::generate {
namespace {

using Kind = WorkerMessage::Kind;

constexpr int out_of_memory_exit = 117;  // a status that nothing else ends with

struct FrameHeader {
    std::uint32_t kind;
    std::int32_t index;
    std::uint64_t length;
};

/// In the worker: a parent that is gone ends it.
void send_all(int socket, const void* data, size_t size) {
    for (const char* at = static_cast<const char*>(data); size > 0;) {
        const ssize_t sent = ::send(socket, at, size, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent <= 0) ::_exit(0);
        at += sent;
        size -= static_cast<size_t>(sent);
    }
}

void send_frame(int socket, Kind kind, int index, const std::string& bytes = {}) {
    const FrameHeader header{static_cast<std::uint32_t>(kind), index, bytes.size()};
    send_all(socket, &header, sizeof header);
    send_all(socket, bytes.data(), bytes.size());
}

/// In the worker: the next index asked for; a parent that is gone ends it.
int next_index(int socket) {
    std::int32_t index = 0;
    for (size_t got = 0; got < sizeof index;) {
        const ssize_t read = ::recv(socket, reinterpret_cast<char*>(&index) + got, sizeof index - got, 0);
        if (read < 0 && errno == EINTR) continue;
        if (read <= 0) ::_exit(0);
        got += static_cast<size_t>(read);
    }
    return index;
}

/// RLIMIT_DATA counts the private writable memory a process maps. RLIMIT_AS would also count what costs nothing: the
/// 64 MB that malloc reserves for each thread, stacks, program text.
void limit_memory(std::uint64_t bytes) {
    if (bytes == 0) return;
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_DATA, &limit);
}

void offer_to_out_of_memory_killer() {
    const int file = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
    if (file < 0) return;
    [[maybe_unused]] const ssize_t ignored = ::write(file, "500", 3);
    ::close(file);
}

/// An allocation that fails ends the worker where it stands: std::bad_alloc would not reach the parent from a thread,
/// or through a function that lets no exception out.
void end_where_memory_does() {
    std::set_new_handler([] { ::_exit(out_of_memory_exit); });
}

/// Runs `work`; an exception is sent to the parent and ends the worker.
template <typename Work>
auto reported(int socket, int index, const Work& work) {
    try {
        return work();
    } catch (const std::bad_alloc&) {
        ::_exit(out_of_memory_exit);
    } catch (const Error& error) {
        send_frame(socket, Kind::error, index, error.what() + ('\0' + error.where()) + '\0' + error.mend());
    } catch (const std::filesystem::filesystem_error& error) {
        send_frame(socket, Kind::error, index, error.code().message() + '\0' + error.path1().string() + '\0');
    } catch (const std::exception& error) {
        send_frame(socket, Kind::other_exception, index, error.what());
    } catch (...) {
        send_frame(socket, Kind::other_exception, index, "an exception without a text");
    }
    ::_exit(1);
}

[[noreturn]] void work(int socket, pid_t parent, const StartWorker& start, const WorkerProcessOptions& options) {
    std::signal(SIGINT, SIG_IGN);
    std::signal(SIGTERM, SIG_IGN);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(0);  // it ended before the line above
    for (const int descriptor : options.parents_descriptor) ::close(descriptor);
    offer_to_out_of_memory_killer();
    limit_memory(options.memory_limit);
    end_where_memory_does();
    const MakeBytes make = reported(socket, 0, start);
    send_frame(socket, Kind::started, 0);
    for (;;) {
        const int index = next_index(socket);
        send_frame(socket, Kind::begun, index);
        send_frame(socket, Kind::made, index, reported(socket, index, [&] { return make(index); }));
    }
}

[[noreturn]] void fail_to_start(int error_number) {
    throw Error(std::string("cannot start a worker process: ") + std::strerror(error_number), {},
                "try fewer --jobs, or raise the limit of processes or of open files");
}

}  // namespace

WorkerProcess::WorkerProcess(const StartWorker& start, const WorkerProcessOptions& options) {
    int end[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, end) != 0) fail_to_start(errno);
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ == 0) {
        ::close(end[0]);
        work(end[1], parent, start, options);
    }
    const int failure = errno;
    ::close(end[1]);
    socket_ = end[0];
    if (process_ > 0) return;
    ::close(socket_);
    fail_to_start(failure);
}

WorkerProcess::~WorkerProcess() {
    end();
    ::close(socket_);
}

int WorkerProcess::end() {
    if (process_ < 0) return status_;
    ::kill(process_, SIGKILL);
    while (::waitpid(process_, &status_, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return status_;
}

bool WorkerProcess::ask(int index) {
    const std::int32_t frame = index;
    ssize_t sent;
    do sent = ::send(socket_, &frame, sizeof frame, MSG_NOSIGNAL);
    while (sent < 0 && errno == EINTR);
    return sent == sizeof frame;
}

bool WorkerProcess::receive(std::vector<WorkerMessage>& message) {
    constexpr size_t chunk = size_t{1} << 18;
    const size_t had = buffer_.size();
    buffer_.resize(had + chunk);
    const ssize_t got = ::recv(socket_, buffer_.data() + had, chunk, MSG_DONTWAIT);
    const int failure = errno;
    buffer_.resize(had + static_cast<size_t>(std::max<ssize_t>(got, 0)));
    take_frames(message);
    if (got < 0) return failure == EAGAIN || failure == EINTR;
    return got > 0;
}

void WorkerProcess::take_frames(std::vector<WorkerMessage>& message) {
    size_t at = 0;
    FrameHeader header;
    while (buffer_.size() - at >= sizeof header) {
        std::memcpy(&header, buffer_.data() + at, sizeof header);
        if (buffer_.size() - at - sizeof header < header.length) break;
        message.push_back({static_cast<Kind>(header.kind), header.index,
                           buffer_.substr(at + sizeof header, static_cast<size_t>(header.length))});
        at += sizeof header + static_cast<size_t>(header.length);
    }
    buffer_.erase(0, at);
}

void throw_error(const WorkerMessage& message) {
    const size_t first = message.bytes.find('\0'), second = message.bytes.find('\0', first + 1);
    throw Error(message.bytes.substr(0, first), message.bytes.substr(first + 1, second - first - 1),
                message.bytes.substr(second + 1));
}

bool ran_out_of_memory(int wait_status) {
    if (WIFSIGNALED(wait_status)) return WTERMSIG(wait_status) == SIGKILL;
    return WEXITSTATUS(wait_status) == out_of_memory_exit;
}

std::string describe_end(int wait_status) {
    if (WIFEXITED(wait_status) && WEXITSTATUS(wait_status) == out_of_memory_exit)
        return "no memory is left to allocate";
    if (!WIFSIGNALED(wait_status)) return "exit status " + std::to_string(WEXITSTATUS(wait_status));
    const int number = WTERMSIG(wait_status);
    return "signal " + std::to_string(number) + " (" + ::strsignal(number) + ")";
}

}  // namespace toile::generate
