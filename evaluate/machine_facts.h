#pragma once

#include <string>
#include <vector>

namespace toile::evaluate {

struct MachineFact {
    std::string name, value;
};

/// What times depend on, as far as the system tells: processor, cores, load average when it was asked, compiler and
/// kind of build.
std::vector<MachineFact> machine_facts();

}  // namespace toile::evaluate
