#include "tests/app/small_corpus.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <thread>

namespace toile::app {

namespace fs = std::filesystem;

namespace {

const char* const scene = R"([scene]
name = "small"
[body]
[contact]
[poses]
count = 8
roles = ["left_lower_arm"]
[level_set]
voxel = 0.02
[path]
joint_step = 1.0
[garment]
source = "patch"
width = 0.2
height = 0.2
edge_length = 0.1
[pins]
corners = "top"
[image]
size = 16
[output]
part = 3
)";

}  // namespace

void SmallCorpus::SetUp() {
    CliTest::SetUp();
    write("scene.toml", scene);
}

void SmallCorpus::TearDown() {
    for (const pid_t process : std::vector<pid_t>(running_)) {
        ::kill(process, SIGKILL);
        wait(process);
    }
    CliTest::TearDown();
}

void SmallCorpus::make_reference() {
    const auto start = std::chrono::steady_clock::now();
    const Outcome outcome = run("generate scene.toml --out reference --jobs 1");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    undisturbed_ = std::chrono::steady_clock::now() - start;
}

void SmallCorpus::expect_reference(const std::string& folder) const {
    EXPECT_EQ(files_in(folder), files_in("reference"));
    for (const char* name : {"dataset.h5", "config.toml"})
        EXPECT_TRUE(bytes(folder + "/" + name) == bytes(std::string("reference/") + name)) << folder << "/" << name;
}

void SmallCorpus::expect_resumes(const std::string& folder, const std::string& settings) {
    const Outcome outcome = run("generate scene.toml --resume --jobs 2 --out " + folder + " " + settings);
    ASSERT_EQ(outcome.status, 0) << outcome.err << outcome.out;
    expect_reference(folder);
}

pid_t SmallCorpus::launch(const std::string& arguments, const std::string& before) {
    const std::string command = "cd '" + (folder_ / "work").string() + "' && exec " + before + " '" + TOILE_PROGRAM +
                                "' " + arguments + " >launched.log 2>&1 </dev/null";
    const pid_t process = ::fork();
    if (process == 0) {
        ::setpgid(0, 0);
        ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
        ::_exit(127);
    }
    ::setpgid(process, process);
    running_.push_back(process);
    return process;
}

int SmallCorpus::wait(pid_t process) {
    running_.erase(std::remove(running_.begin(), running_.end(), process), running_.end());
    int status = 0;
    if (::waitpid(process, &status, 0) != process) return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

void SmallCorpus::wait_for(pid_t process, const std::string& name) const {
    siginfo_t ended = {};
    while (!fs::exists(path(name))) {
        ASSERT_TRUE(::waitid(P_PID, static_cast<id_t>(process), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
                    ended.si_pid == 0)
            << "ended before " << name << " was there: " << said();
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
}

std::string SmallCorpus::bytes(const std::string& name) const {
    std::ifstream stream(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void SmallCorpus::flip_bit(const std::string& name, std::size_t bit) const {
    std::string content = bytes(name);
    ASSERT_LT(bit / 8, content.size()) << name;
    content[bit / 8] = static_cast<char>(content[bit / 8] ^ (1 << (bit % 8)));
    write(name, content);
}

std::vector<std::string> SmallCorpus::files_in(const std::string& folder) const {
    std::vector<std::string> name;
    for (const auto& entry : fs::recursive_directory_iterator(path(folder)))
        name.push_back(fs::relative(entry.path(), path(folder)).string());
    std::sort(name.begin(), name.end());
    return name;
}

std::vector<pid_t> children_of(pid_t process) {
    const std::string id = std::to_string(process);
    std::ifstream file("/proc/" + id + "/task/" + id + "/children");
    std::vector<pid_t> child;
    for (pid_t one; file >> one;) child.push_back(one);
    return child;
}

}  // namespace toile::app
