#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

#include "tests/app/cli_runner.h"

namespace toile::app {

/// A small corpus, made of a swatch that hangs beside the body's moving arm, in parts of three samples, and what
/// disturbs its making.
class SmallCorpus : public CliTest {
  protected:
    static constexpr int samples = 8;

    void SetUp() override;
    void TearDown() override;

    /// Makes the corpus undisturbed in `reference`.
    void make_reference();
    /// `folder` holds what `reference` does, to the last byte, and nothing else.
    void expect_reference(const std::string& folder) const;
    /// Goes on with `folder` until it is whole, and compares it.
    void expect_resumes(const std::string& folder, const std::string& settings = {});

    /// Starts the program and returns its process. `before` may hold variables and wrappers that replace themselves.
    pid_t launch(const std::string& arguments, const std::string& before = {});
    /// Waits for a launched process: exit status, or 1000 + the signal's number.
    int wait(pid_t process);
    /// What a launched process wrote, both streams.
    std::string said() const { return bytes("launched.log"); }
    /// Waits until a file of this name is there, as long as the process lives.
    void wait_for(pid_t process, const std::string& name) const;

    std::string bytes(const std::string& name) const;
    void flip_bit(const std::string& name, std::size_t bit) const;
    std::vector<std::string> files_in(const std::string& folder) const;  ///< names without the folder's, sorted

    std::chrono::duration<double> undisturbed_ = {};  ///< how long the reference took

  private:
    std::vector<pid_t> running_;
};

/// Processes whose parent is `process`.
std::vector<pid_t> children_of(pid_t process);

}  // namespace toile::app
