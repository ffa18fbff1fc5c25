#include "files/trial_run.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

#include "cloth/error.h"

namespace toile::files {
namespace {

[[noreturn]] void run_child(int cpu_seconds, const std::function<void()>& read) {
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGXCPU}) std::signal(signal, SIG_DFL);
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    const rlimit time{static_cast<rlim_t>(cpu_seconds), static_cast<rlim_t>(cpu_seconds)};
    ::setrlimit(RLIMIT_CPU, &time);
#ifndef __SANITIZE_ADDRESS__  // whose shadow takes terabytes of addresses
    const rlimit memory{rlim_t{4} << 30, rlim_t{4} << 30};
    ::setrlimit(RLIMIT_AS, &memory);
#endif
    const int nowhere = ::open("/dev/null", O_WRONLY);
    if (nowhere >= 0) {
        ::dup2(nowhere, STDOUT_FILENO);
        ::dup2(nowhere, STDERR_FILENO);
    }
    try {
        read();
    } catch (...) {
    }
    ::_exit(0);
}

}  // namespace

void trial_run(const std::string& path, int cpu_seconds, const std::function<void()>& read) {
    const pid_t child = ::fork();
    if (child < 0) return;  // no process to spare: the reader has to do without its net
    if (child == 0) run_child(cpu_seconds, read);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
    const bool endless = WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL);
    throw Error(endless ? "the file is damaged: reading it does not come to an end"
                        : "the file is damaged: its reader broke down over it",
                path);
}

}  // namespace toile::files
