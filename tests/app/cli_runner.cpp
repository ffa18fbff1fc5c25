#include "tests/app/cli_runner.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace toile::app {

namespace fs = std::filesystem;

namespace {

std::string read(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

std::vector<std::string> Outcome::err_lines() const {
    std::vector<std::string> line;
    std::istringstream stream(err);
    for (std::string one; std::getline(stream, one);) line.push_back(one);
    return line;
}

void CliTest::SetUp() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("toile_cli_" + std::to_string(getpid()) + "_" + info->name());
    fs::create_directories(folder_ / "work");
}

void CliTest::TearDown() {
    std::error_code ignored;
    fs::permissions(folder_ / "work", fs::perms::owner_all, ignored);
    fs::remove_all(folder_, ignored);
}

void CliTest::write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / "work" / name, std::ios::binary) << text;
}

Outcome CliTest::run(const std::string& arguments, const std::string& before) const {
    const fs::path out = folder_ / "stdout", err = folder_ / "stderr";
    const std::string command = "cd '" + (folder_ / "work").string() + "' && { " + before + " '" + TOILE_PROGRAM +
                                "' " + arguments + " ; } >'" + out.string() + "' 2>'" + err.string() + "' </dev/null";
    const int result = std::system(command.c_str());
    Outcome outcome;
    outcome.status = WIFEXITED(result) ? WEXITSTATUS(result) : 1000 + WTERMSIG(result);
    outcome.out = read(out);
    outcome.err = read(err);
    return outcome;
}

void CliTest::expect_refused(const std::string& arguments, const std::string& expected, const std::string& before) {
    const std::vector<std::string> earlier = files();
    const Outcome outcome = run(arguments, before);
    std::vector<std::string> said;  // without the log lines of work that had begun
    for (const std::string& line : outcome.err_lines())
        if (line.empty() || line.front() != '[') said.push_back(line);
    EXPECT_EQ(outcome.status, 2) << arguments << "\n" << outcome.err;
    ASSERT_FALSE(said.empty()) << arguments;
    EXPECT_LE(said.size(), 2u) << arguments << "\n" << outcome.err;
    EXPECT_EQ(said.front().rfind("toile: ", 0), 0u) << said.front();
    EXPECT_THAT(said.front(), ::testing::HasSubstr(expected)) << arguments;
    EXPECT_EQ(files(), earlier) << arguments << " left something behind";
}

std::vector<std::string> CliTest::files() const {
    std::vector<std::string> name;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "work"))
        name.push_back(fs::relative(entry.path(), folder_ / "work").string());
    std::sort(name.begin(), name.end());
    return name;
}

}  // namespace toile::app
