#include "bench/peak_memory.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <exception>

namespace toile::bench {

double peak_memory_of(const std::function<bool()>& work) {
    const pid_t child = fork();
    if (child < 0) return -1;
    if (child == 0) {
        bool good = false;
        try {
            good = work();
        } catch (const std::exception&) {
        }
        _exit(good ? 0 : 1);
    }
    int status = 0;
    rusage usage{};
    if (wait4(child, &status, 0, &usage) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0) return -1;
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace toile::bench
