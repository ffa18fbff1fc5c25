#include "evaluate/machine_facts.h"

#include <sys/utsname.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

namespace toile::evaluate {
namespace {

/// The first value of a key in Linux' description of its processors.
std::string processor_model() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name"))
            if (const size_t colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
    utsname system{};
    return uname(&system) == 0 ? system.machine : "unknown";
}

std::string load_average() {
    double load[1];
    if (getloadavg(load, 1) != 1) return "unknown";
    std::ostringstream text;
    text.precision(2);
    text << std::fixed << load[0];
    return text.str();
}

}  // namespace

std::vector<MachineFact> machine_facts() {
#ifdef NDEBUG
    const char* const build = "optimised";
#else
    const char* const build = "with assertions";
#endif
    return {{"processor", processor_model()},
            {"cores", std::to_string(std::thread::hardware_concurrency())},
            {"load_at_start", load_average()},
            {"compiler", std::string(__VERSION__)},
            {"build", build}};
}

}  // namespace toile::evaluate
