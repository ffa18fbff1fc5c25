#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace toile::app {

/// What a run of the program left behind.
struct Outcome {
    int status = -1;  ///< exit status; 1000 + the signal's number if it was killed
    std::string out, err;
    std::vector<std::string> err_lines() const;
};

/// Runs the program in a folder of its own, which is removed afterwards.
class CliTest : public ::testing::Test {
  protected:
    void SetUp() override;
    void TearDown() override;

    std::string path(const std::string& name) const { return (folder_ / "work" / name).string(); }
    void write(const std::string& name, const std::string& text) const;
    /// `arguments` as a shell reads them; `before` stands in front, for limits and the like.
    Outcome run(const std::string& arguments, const std::string& before = {}) const;
    /// The run says in one line, and perhaps a second with the mend, that the input is at fault, names `expected`, and
    /// leaves no file that was not there before.
    void expect_refused(const std::string& arguments, const std::string& expected, const std::string& before = {});
    std::vector<std::string> files() const;  ///< all there are in the folder, sorted

    std::filesystem::path folder_;
};

}  // namespace toile::app
