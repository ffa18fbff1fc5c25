#include "files/trial_run.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <exception>
#include <fstream>

#include "cloth/error.h"

#if defined(__SANITIZE_ADDRESS__)  // g++
#define TOILE_ADDRESS_SANITIZER
#elif defined(__has_feature)  // clang
#if __has_feature(address_sanitizer)
#define TOILE_ADDRESS_SANITIZER
#endif
#endif

namespace toile::files {
namespace {

/// What this process has mapped [bytes], which may be much without being used.
[[maybe_unused]] rlim_t address_space() {
    rlim_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

void limit_child(int cpu_seconds) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // nobody is left to hear the answer
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGXCPU}) std::signal(signal, SIG_DFL);
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    const rlimit time{static_cast<rlim_t>(cpu_seconds), static_cast<rlim_t>(cpu_seconds)};
    ::setrlimit(RLIMIT_CPU, &time);
#ifndef TOILE_ADDRESS_SANITIZER  // whose shadow takes terabytes of addresses
    const rlim_t most = address_space() + (rlim_t{4} << 30);
    const rlimit memory{most, most};
    ::setrlimit(RLIMIT_AS, &memory);
#endif
    const int nowhere = ::open("/dev/null", O_WRONLY);
    if (nowhere < 0) return;
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
}

[[noreturn]] void run_child(int cpu_seconds, int answer, const std::function<std::string()>& read) {
    limit_child(cpu_seconds);
    std::string complaint;
    try {
        complaint = read();
    } catch (const std::exception& error) {
        complaint = error.what();
    }
    // Short enough for a pipe to hold whole.
    complaint.resize(std::min<size_t>(complaint.size(), 1000));
    const bool sent = ::write(answer, complaint.data(), complaint.size()) == static_cast<ssize_t>(complaint.size());
    ::_exit(sent ? 0 : 1);
}

std::string received(int answer) {
    std::string text;
    std::array<char, 1024> block;
    while (true) {
        const ssize_t size = ::read(answer, block.data(), block.size());
        if (size < 0 && errno == EINTR) continue;
        if (size <= 0) break;
        text.append(block.data(), static_cast<size_t>(size));
    }
    return text;
}

}  // namespace

std::string trial_run(const std::string& path, int cpu_seconds, const std::function<std::string()>& read) {
    std::array<int, 2> channel;
    if (::pipe2(channel.data(), O_CLOEXEC) != 0) throw Error("there is no room for a pipe to read the file", path);
    const pid_t child = ::fork();
    if (child == 0) run_child(cpu_seconds, channel[1], read);
    ::close(channel[1]);
    if (child < 0) {
        ::close(channel[0]);
        throw Error("there is no room for a process to read the file", path);
    }
    const std::string complaint = received(channel[0]);
    ::close(channel[0]);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return complaint;
    const bool endless = WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL);
    throw Error(endless ? "the file is damaged: reading it does not come to an end"
                        : "the file is damaged: its reader broke down over it",
                path);
}

}  // namespace toile::files
